"""The levels that editors draw on a plane: computed, and kept."""

from collections.abc import Sequence
from dataclasses import dataclass

import gpu
import numpy as np
import prefilter

from ...bridge import images
from ...bridge.drawing import uploaded
from ...bridge.images import FloatArray, Picture
from ...bridge.previews import Previews
from ...core.alpha import associated
from ...core.jobs import Progress, go_on, share
from .atlas import packed

LONGEST_SIDE = 4096
"""Of the finest level that is drawn; those of larger images start farther down."""

_DECODED, _FILTERED = 0.2, 0.9  # What the progress is once these steps are done.


@dataclass
class Plane:
    """The levels of one image.

    Attributes:
        image_uid: The image's session_uid.
        filter: What the levels were made with.
        size: The width and height of the finest level.
        level_count: How many there are.
        atlas: All of them, see `atlas.packed`; empty once they are a texture.
        is_data: Whether values are shown as they are stored.
        is_stale: Whether the image has changed since.
    """

    image_uid: int
    filter: str
    size: tuple[int, int]
    level_count: int
    atlas: FloatArray | None
    is_data: bool
    is_stale: bool = False
    _texture: gpu.types.GPUTexture | None = None

    def depends_on(self, name: str) -> bool:
        """Tells whether it was made of an object of this name; none is."""
        del name
        return False

    def texture(self) -> gpu.types.GPUTexture:
        """Returns the levels as a texture; main thread only."""
        if self._texture is None:
            assert self.atlas is not None
            self._texture, self.atlas = uploaded(self.atlas), None
        return self._texture


_planes: Previews[Plane] = Previews()
keep, find, drop = _planes.keep, _planes.find, _planes.drop
register, unregister = _planes.register, _planes.unregister


def compute(picture: Picture, image_uid: int, filter: str, progress: Progress) -> Plane:
    """Computes the levels of an image that tiles the plane.

    Args:
        picture: The image.
        image_uid: The session_uid of the image.
        filter: A key of `choices.TABLE_FILTERS`.
        progress: Called with the fraction done.

    Raises:
        prefilter.Cancelled: `progress` returned False.
        ValueError: The library refuses the image.
        MemoryError: There is not enough memory.
    """
    linear = images.scene_linear(picture, lambda: go_on(progress, 0.0))
    if picture.alpha_is_straight:
        linear = associated(linear)
    go_on(progress, _DECODED)
    levels: Sequence[FloatArray] = prefilter.sampling_levels(
        linear,
        filter,
        wrap="repeat",
        premultiplied=True,
        progress=share(progress, _DECODED, _FILTERED),
    )
    first = next(k for k, level in enumerate(levels) if max(level.shape[:2]) <= LONGEST_SIDE)
    levels = levels[first:]
    atlas = packed([np.nan_to_num(level) for level in levels])
    go_on(progress, 1.0)
    height, width = levels[0].shape[:2]
    return Plane(image_uid, filter, (width, height), len(levels), atlas, picture.is_data)
