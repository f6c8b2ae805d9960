# SPDX-License-Identifier: GPL-3.0-or-later

"""The levels that editors draw on a plane: computed, and kept."""

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
"""Of the finest level that is drawn, in texels; larger images are made smaller."""

_DECODED, _RESIZED, _FILTERED = 0.1, 0.3, 0.9  # What the progress is once these steps are done.


@dataclass
class Plane:
    """The levels of one image.

    Attributes:
        image_uid: The image's session_uid.
        filter: What the levels were made with.
        size: The width and height of the finest level.
        aspect: The width of the image by its height.
        level_count: How many there are.
        atlas: All of them, see `atlas.packed`; empty once they are a texture.
        is_data: Whether values are shown as they are stored.
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
        """Tells whether it was made of an object of this name; none is."""
        del name
        return False

    def texture(self) -> gpu.types.GPUTexture:
        """Returns the levels as a texture; main thread only."""
        from ...bridge.drawing import uploaded

        if self._texture is None:
            assert self.atlas is not None
            self._texture, self.atlas = uploaded(self.atlas), None
        return self._texture


_planes: Previews[Plane] = Previews()
keep, find, drop = _planes.keep, _planes.find, _planes.drop
register, unregister = _planes.register, _planes.unregister
VIEW = View(_planes, "prefilter_plane", "use_plane")


def compute(
    picture: "Picture", image_uid: int, filter: str, progress: Progress, threads: int = 0
) -> Plane:
    """Computes the levels of an image that tiles the plane.

    Args:
        picture: The image.
        image_uid: The session_uid of the image.
        filter: A key of `choices.TABLE_FILTERS`.
        progress: Called with the fraction done.
        threads: How many threads to use; 0 for all.

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
    smaller = min(1.0, LONGEST_SIDE / max(width, height))
    size = (max(1, round(smaller * width)), max(1, round(smaller * height)))
    if smaller < 1.0:
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
