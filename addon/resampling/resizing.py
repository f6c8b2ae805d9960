"""Resizing an image: what was read is computed anywhere, and then written to Blender or a file.

The operator and the command are two ways to call this.
"""

from functools import partial
from pathlib import Path

import bpy
import numpy as np
import prefilter

from ..bridge import derived, images
from ..bridge.files import pictures, staging
from ..bridge.images import FloatArray, Picture
from ..core import alpha
from ..core.jobs import Progress, go_on, share
from ..core.outcome import Outcome
from .choices import FILTERS, ResizeSettings

_DECODED, _RESIZED = 0.1, 0.9  # What the progress is once these steps are done.
_BYTE, _SHORT = 255, 65535


class Resizing:
    """One image of another size.

    `write` belongs on the main thread; `compute` touches no Blender data and runs on any thread.
    """

    def __init__(
        self,
        picture: Picture,
        settings: ResizeSettings,
        *,
        target: Path | None = None,
        in_place: bool = False,
    ) -> None:
        """Keeps what was read.

        Args:
            picture: The image.
            settings: The size, the filter, and more.
            target: A file to write; None for a new image datablock.
            in_place: Whether whatever uses the image then uses the new one.
        """
        height, width = picture.stored.shape[:2]
        self.old_size = (width, height)
        self.new_size = settings.new_size(width, height)
        self._picture = picture
        self._settings = settings
        self._target = target
        self._in_place = in_place
        self._stored: FloatArray | None = None
        self._staged: staging.StagedFile | None = None

    def compute(self, progress: Progress) -> None:
        """Decodes, filters and encodes the pixels, and stages the file.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The library refuses the image or the size.
            MemoryError: There is not enough memory.
            OSError: The file cannot be written.
        """
        picture = self._picture
        linear = images.scene_linear(picture, partial(go_on, progress, 0.0))
        go_on(progress, _DECODED)
        result = self._resized(linear, share(progress, _DECODED, _RESIZED))
        check = partial(go_on, progress, _RESIZED)
        if self._target is None:
            self._stored = images.encoded(picture, result, check)
        else:
            check()
            self._staged = _stage(self._target, picture, result)
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Makes the image, or puts the file into place.

        Raises:
            OSError: It cannot be.
        """
        width, height = self.new_size
        did = (
            f"Resized '{self._picture.name}' from {self.old_size[0]} x {self.old_size[1]} to "
            f"{width} x {height} pixels with {FILTERS[self._settings.filter].label}"
        )
        if self._staged is not None:
            self._staged.commit()
            return Outcome(f"{did} into '{self._target}'", files=[str(self._target)])
        assert self._stored is not None
        image = derived.write_picture(
            self._picture, f"{width}x{height}", self._stored, like_source=True
        )
        if self._in_place:
            images.find(self._picture.name).user_remap(image)
        return Outcome(f"{did}: '{image.name}'", images=[image.name])

    def discard(self) -> None:
        """Removes the file that was staged, if it was not put into place."""
        if self._staged is not None:
            self._staged.discard()

    def _resized(self, linear: FloatArray, progress: Progress) -> FloatArray:
        picture, settings = self._picture, self._settings
        width, height = self.new_size
        result = prefilter.resize(
            linear,
            width,
            height,
            filter=settings.filter,
            constrained=settings.use_constrained or not picture.is_float,
            wrap=settings.wrap,
            premultiplied=not picture.alpha_is_straight,
            progress=progress,
            threads=settings.threads,
        )
        if picture.alpha_is_coverage:
            np.clip(result[..., 3], 0.0, 1.0, out=result[..., 3])
        return result


def read(image: bpy.types.Image) -> Picture:
    """Copies an image's pixels; raises ValueError where it has none, or several tiles."""
    images.check_untiled(image)
    return images.read(image)


def _stage(target: Path, picture: Picture, linear: FloatArray) -> staging.StagedFile:
    """Writes a file with the alpha, the encoding and the depth that its kind should have."""
    covers, straight = picture.alpha_is_coverage, picture.alpha_is_straight
    if target.suffix.lower() == ".exr":
        pixels = alpha.associated(linear) if straight else linear
        return pictures.stage(target, pixels, is_data=picture.is_data, is_half=not picture.is_float)
    pixels = alpha.unassociated(linear) if covers and not straight else linear
    if not picture.is_data:
        pixels = prefilter.to_srgb(pixels)
    most = _SHORT if picture.is_float else _BYTE
    whole = np.rint(pixels.clip(0.0, 1.0) * most).astype(np.uint16 if most == _SHORT else np.uint8)
    return pictures.stage(target, whole, is_data=picture.is_data, is_half=False)
