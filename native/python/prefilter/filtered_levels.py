"""Levels of a mipmap that know which filter made them (section 6.2)."""

from collections.abc import Iterable
from typing import Generic, TypeVar

import numpy as np
import numpy.typing as npt

from . import _native
from ._border.arguments import (
    ProgressCallback,
    Wrap,
    as_level_count,
    as_name,
    as_progress,
    as_wrap,
    progress_part,
)
from ._border.arrays import FloatArray, as_float_image, as_threads, check_texels

SAMPLING_FILTERS = tuple(_native.sampling_filters())
"""The kernels that sampling tables and `sampling_levels` are made for."""

_CHANNELS_AT_ONCE = 4

Value = TypeVar("Value", bound=np.generic)


class FilteredLevels(list[npt.NDArray[Value]], Generic[Value]):
    """A list of arrays (height, width, channels), level 0 first.

    Attributes:
        filter: The name of the filter that made them; None where it is not known.
    """

    def __init__(self, levels: Iterable[npt.NDArray[Value]] = (), filter: str | None = None):
        super().__init__(levels)
        self.filter = filter


def sampling_levels(
    image: npt.ArrayLike,
    filter: str = "lanczos2",
    *,
    wrap: Wrap = "clamp",
    levels: int | None = None,
    premultiplied: bool = False,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FilteredLevels[np.float32]:
    """The levels that a sampling table of the same filter fits.

    Level k is the image under the kernel with its unit as wide as a texel of the level: what the
    exact filter gives at the texels' centres. Level 0 is the image itself where the kernel
    interpolates ("box", "tent", "lanczos2", "lanczos3"); the others blur it. Nothing is clipped:
    kernels with negative lobes leave the range of the image.

    Args:
        image: (height, width, channels) of any number, scene-linear, row 0 at v = 0. Bytes (uint8)
            stand for a 255th each.
        filter: A name of `SAMPLING_FILTERS`.
        wrap: What lies outside of the image: "clamp", "repeat" or "border" (zero), or a pair of
            these for u and v.
        levels: How many to return, level 0 included; None = down to 1 x 1.
        premultiplied: Whether the colors of an image of 2 or 4 channels are multiplied by alpha
            already, or its last channel is no alpha: then every channel is filtered as it stands.
            Otherwise alpha is clipped to [0, 1] and the colors are multiplied by it, and they stay
            so in all levels: samples are weighted sums, which are right only of multiplied colors.
            Divide samples by their alpha.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        The levels, float32 (height, width, channels). Each has half the sides of the one before,
        rounded down, never less than 1.

    Raises:
        ValueError: An argument is out of range, or a texel is not finite or beyond 1e30.
        MemoryError: The levels do not fit into memory.
        Cancelled: The progress callback returned False.
    """
    stored = as_float_image("image", image)
    channels = stored.shape[2]
    groups = range(0, channels, _CHANNELS_AT_ONCE)
    if len(groups) > 1:
        check_texels("image", stored)  # here, where channels have their own numbers
    parts = []
    for begin in groups:
        end = begin + _CHANNELS_AT_ONCE
        parts.append(
            _native.sampling_levels(
                stored if channels <= end - begin else np.ascontiguousarray(stored[..., begin:end]),
                as_name("filter", filter),
                as_wrap(wrap),
                as_level_count(levels),
                bool(premultiplied) or len(groups) > 1,
                progress_part(progress, begin / channels, min(end / channels, 1.0))
                if len(groups) > 1
                else as_progress(progress),
                as_threads(threads),
            )
        )
    joined: list[FloatArray] = (
        parts[0]
        if len(parts) == 1
        else [np.concatenate(level, axis=2) for level in zip(*parts, strict=True)]
    )
    return FilteredLevels(joined, filter)
