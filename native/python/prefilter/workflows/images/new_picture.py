# SPDX-License-Identifier: GPL-3.0-or-later

"""Computing a new image from an old one, on any thread, and writing or handing on the result."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import prefilter

from ...files import staging
from .. import alpha
from ..files import pictures
from ..outcome import Outcome
from ..picture import Encoding, FloatArray, Picture, encoded, in_rec709, scene_linear
from ..progress import Progress, go_on, share
from ..wording import Sentence

Bytes = NDArray[np.uint8]
Keep = Callable[["NewPicture", FloatArray], Outcome]

_DECODED, _FILTERED = 0.1, 0.9  # Progress after decoding, and after filtering.
_BYTE, _SHORT = 255, 65535


class NewPicture:
    """The computation of one new image; subclasses define the filter.

    `write` belongs on the main thread; `compute` touches no Blender data and runs on any thread.
    """

    def __init__(
        self,
        picture: Picture,
        settings: Any,
        *,
        target: Path | None = None,
        keep: Keep | None = None,
    ) -> None:
        """Takes the inputs.

        Args:
            picture: The image.
            settings: Settings of the subclass.
            target: A file to write; None to call `keep` instead.
            keep: Creates an image from the new pixels, in the encoding of the picture.
        """
        height, width = picture.shape[:2]
        self.old_size = (width, height)
        self.picture = picture
        self._settings = settings
        self._target = target
        self._keep = keep
        self.metadata: Mapping[str, str] | None = None
        """Key-value pairs to store in the file."""
        self._stored: FloatArray | None = None
        self._staged: staging.StagedFile | None = None

    @property
    def suffix(self) -> str:
        """Suffix of the new image's name."""
        raise NotImplementedError

    @property
    def summary(self) -> str:
        """Summary of the operation, for the user."""
        raise NotImplementedError

    def filtered(self, linear: FloatArray, progress: Progress) -> FloatArray:
        """Returns the pixels of the new image.

        Args:
            linear: The pixels of the old one as light, with alpha as it is stored.
            progress: Called with the fraction done.
        """
        raise NotImplementedError

    def filtered_bytes(self, progress: Progress) -> Bytes | None:
        """Returns the pixels of the new image as bytes, in the encoding of the picture.

        Returns None if the subclass cannot filter bytes; `filtered` is then called.

        Args:
            progress: Called with the fraction done.
        """
        return None

    @property
    def keeps_bytes(self) -> bool:
        """Whether bytes are filtered to bytes of the same encoding, which the library supports."""
        picture = self.picture
        if picture.texels.dtype != np.uint8 or picture.encoding is Encoding.OCIO:
            return False
        if self._target is None:
            return True
        is_encoded = picture.is_data or picture.encoding is Encoding.SRGB
        return is_encoded and self._target.suffix.lower() == ".png"

    def compute(self, progress: Progress) -> None:
        """Decodes, filters and encodes the pixels, and stages the file.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The library refuses the image or the settings.
            MemoryError: There is not enough memory.
            OSError: The file cannot be written.
        """
        picture = self.picture
        if self.keeps_bytes:
            filtered = self.filtered_bytes(share(progress, 0.0, _FILTERED))
            if filtered is not None:
                self._finish_bytes(filtered)
                go_on(progress, 1.0)
                return
        linear = scene_linear(picture, partial(go_on, progress, 0.0))
        go_on(progress, _DECODED)
        result = self.filtered(linear, share(progress, _DECODED, _FILTERED))
        if picture.alpha_is_coverage:
            np.clip(result[..., 3], 0.0, 1.0, out=result[..., 3])
        check = partial(go_on, progress, _FILTERED)
        if self._target is None:
            self._stored = encoded(picture, result, check)
        else:
            check()
            self._staged = _stage(self._target, picture, result, self.metadata)
        go_on(progress, 1.0)

    def _finish_bytes(self, filtered: Bytes) -> None:
        picture = self.picture
        if self._target is None:
            self._stored = replace(picture, texels=filtered).stored
        else:
            self._staged = pictures.stage(
                self._target,
                pictures.in_file_channels(filtered, is_gray=picture.is_gray),
                is_data=picture.is_data,
                is_half=False,
                metadata=self.metadata,
            )

    def write(self) -> Outcome:
        """Makes the image, or puts the file into place.

        Raises:
            OSError: The file cannot be put into place.
        """
        if self._staged is not None:
            self._staged.commit()
            summary = Sentence("{} into '{}'", self.summary, self._target)
            return Outcome(summary, files=[str(self._target)])
        assert self._stored is not None
        assert self._keep is not None
        return self._keep(self, self._stored)

    def discard(self) -> None:
        """Removes the staged file if it was not put into place."""
        if self._staged is not None:
            self._staged.discard()


def _stage(
    target: Path, picture: Picture, linear: FloatArray, metadata: Mapping[str, str] | None
) -> staging.StagedFile:
    """Stages a file with the alpha, encoding and depth that suit its format."""
    covers, straight = picture.alpha_is_coverage, picture.alpha_is_straight
    if target.suffix.lower() == ".exr":
        pixels = alpha.associated(linear) if straight else linear
        return pictures.stage(
            target,
            pictures.in_file_channels(pixels, is_gray=picture.is_gray),
            is_data=picture.is_data,
            is_half=not picture.is_float,
            linear_space=picture.linear_space,
            has_alpha=covers,
            metadata=metadata,
        )
    pixels = alpha.unassociated(linear) if covers and not straight else linear
    if picture.space is not None:
        pixels = encoded(replace(picture, encoding=Encoding.SPACE), pixels)
    elif not picture.is_data:
        pixels = prefilter.to_srgb(in_rec709(picture, pixels))
    most = _SHORT if picture.is_float else _BYTE
    whole = np.rint(pixels.clip(0.0, 1.0) * most).astype(np.uint16 if most == _SHORT else np.uint8)
    return pictures.stage(
        target,
        pictures.in_file_channels(whole, is_gray=picture.is_gray),
        is_data=picture.is_data,
        is_half=False,
        chunks=() if picture.space is None else picture.space.chunks,
        metadata=metadata,
    )
