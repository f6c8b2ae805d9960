# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels of a mipmap that store the name of their filter (section 6.2)."""

from collections.abc import Iterable
from functools import partial
from typing import Generic, TypeVar

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    Wrap,
    as_level_count,
    as_name,
    as_wrap,
    set_options,
)
from .._border.arrays import FloatArray, as_image, as_threads, in_form_of
from .._border.channels import in_channel_groups
from .._border.names import Kernel
from ..images.filters import names_for

SAMPLING_FILTERS: tuple[Kernel, ...] = names_for("sampling")
"""Kernels that sampling tables and `sampling_levels` support."""

_CHECKS: dict[str, Check] = {
    "filter": partial(as_name, "filter"),
    "wrap": as_wrap,
    "levels": as_level_count,
    "premultiplied": bool,
    "threads": as_threads,
}

Value = TypeVar("Value", bound=np.generic)


class FilteredLevels(list[npt.NDArray[Value]], Generic[Value]):
    """A list of arrays (height, width, channels) or (height, width), level 0 first.

    Attributes:
        filter: The name of the filter that made them; None if unknown.
    """

    def __init__(self, levels: Iterable[npt.NDArray[Value]] = (), filter: str | None = None):
        super().__init__(levels)
        self.filter = filter


def sampling_levels(
    image: npt.ArrayLike,
    filter: Kernel = "lanczos2",
    *,
    wrap: Wrap = "clamp",
    levels: int | None = None,
    premultiplied: bool = False,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FilteredLevels[np.float32]:
    """Mipmap levels for sampling tables of the same filter.

    Level k is the image under the kernel with its unit as wide as a texel of the level, that is 2^k
    texels of the image: the result of the exact filter at the texels' centers. Level 0 is the image
    itself if the kernel interpolates ("box", "tent", "lanczos2", "lanczos3"); the others blur it.
    Nothing is clipped: kernels with negative lobes leave the range of the image.

    Args:
        image: (height, width, channels) of any number, or (height, width), scene-linear, row 0 at
            v = 0. uint8 is divided by 255, uint16 by 65535.
        filter: A name of `SAMPLING_FILTERS`.
        wrap: Texels outside of the image: "clamp", "repeat" or "border" (zero), or a pair of these
            for u and v.
        levels: How many to return, including level 0; None = down to 1 x 1.
        premultiplied: Whether the colors of an image of 2 or 4 channels are already multiplied by
            alpha, or its last channel is not alpha: then every channel is filtered as it stands.
            Otherwise alpha is clipped to [0, 1] and the colors are multiplied by it, and remain
            multiplied in all levels: samples are weighted sums, which need multiplied colors.
            Divide samples by their alpha.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        The levels, float32, with as many axes as the image, down to 1 x 1. Each has half the sides
        of the previous one, rounded up: texels nest, and unless sides are powers of two the last
        ones extend beyond the image. (`mipmaps` rounds down, like graphics cards; texels then do
        not nest, and tables lose their advantage.)

    Raises:
        ValueError: An argument is out of range, or a texel is not finite or beyond 1e30.
        MemoryError: The levels do not fit into memory.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.SamplingLevelsOptions(), _CHECKS, locals())

    def of_channels(
        part: FloatArray, multiplied: bool, reports: ProgressCallback | None
    ) -> list[FloatArray]:
        options.premultiplied = multiplied
        return _native.sampling_levels(part, options, reports)

    groups = in_channel_groups(
        as_image("image", image), options.premultiplied, of_channels, progress
    )
    joined = [
        level[0] if len(level) == 1 else np.concatenate(level, axis=2)
        for level in zip(*groups, strict=True)
    ]
    return FilteredLevels((in_form_of(image, level) for level in joined), filter)
