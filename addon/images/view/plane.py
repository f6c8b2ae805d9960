# SPDX-License-Identifier: GPL-3.0-or-later

"""Preview planes: the levels of images that editors draw on a plane."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import gpu
import prefilter

from ...bridge.previews import Previews
from ...bridge.views import View
from ...core.alpha import associated
from ...core.jobs import Progress, go_on, share
from .atlas import packed

if TYPE_CHECKING:
    from ...bridge.images import FloatArray, Picture

LONGEST_SIDE = 4096
"""Longest side of the finest level, in texels; larger images are resized."""

_DECODED, _RESIZED, _FILTERED = 0.1, 0.3, 0.9  # The progress after each stage.


@dataclass
class Plane:
    """The levels of one image.

    Attributes:
        image_uid: The image's session_uid.
        filter: The filter of the levels.
        size: The width and height of the finest level.
        aspect: The width of the image divided by its height.
        level_count: The number of levels.
        atlas: All levels in one array, see `atlas.packed`; None after the upload.
        is_data: Whether the stored values are shown.
        is_stale: Whether the image has changed since.
    """

    image_uid: int
    filter: str
    size: tuple[int, int]
    aspect: float
    level_count: int
    atlas: "FloatArray | None"
    is_data: bool
    is_stale: bool = False
    _texture: gpu.types.GPUTexture | None = None

    def depends_on(self, name: str) -> bool:
        """Returns whether it depends on an object; always False."""
        del name
        return False

    def texture(self) -> gpu.types.GPUTexture:
        """Returns the levels as a texture; main thread only."""
        from ...bridge.drawing import upload

        if self._texture is None:
            assert self.atlas is not None
            self._texture, self.atlas = upload(self.atlas), None
        return self._texture


_planes: Previews[Plane] = Previews()
keep, find, drop = _planes.keep, _planes.find, _planes.drop
register, unregister = _planes.register, _planes.unregister
VIEW = View(_planes, "prefilter_plane", "use_plane")


def compute(
    picture: "Picture", image_uid: int, filter: str, progress: Progress, threads: int = 0
) -> Plane:
    """Computes the levels of an image, wrapped by repetition.

    Args:
        picture: The image.
        image_uid: The session_uid of the image.
        filter: A key of `choices.TABLE_FILTERS`.
        progress: Called with the fraction done.
        threads: The number of threads; 0 for all.

    Raises:
        prefilter.Cancelled: `progress` returned False.
        ValueError: The library refuses the image.
        MemoryError: There is not enough memory.
    """
    from ...bridge import images

    linear = images.scene_linear(picture, lambda: go_on(progress, 0.0))
    if picture.alpha_is_straight:
        linear = associated(linear)
    go_on(progress, _DECODED)
    height, width = linear.shape[:2]
    scale = min(1.0, LONGEST_SIDE / max(width, height))
    size = (max(1, round(scale * width)), max(1, round(scale * height)))
    if scale < 1.0:
        linear = prefilter.resize(
            linear,
            *size,
            wrap="repeat",
            premultiplied=True,
            progress=share(progress, _DECODED, _RESIZED),
            threads=threads,
        )
    levels = prefilter.sampling_levels(
        linear,
        cast("Any", filter),
        wrap="repeat",
        premultiplied=True,
        progress=share(progress, _RESIZED, _FILTERED),
        threads=threads,
    )
    atlas = packed(levels)
    go_on(progress, 1.0)
    return Plane(image_uid, filter, size, width / height, len(levels), atlas, picture.is_data)
