# SPDX-License-Identifier: GPL-3.0-or-later

"""Samples of a mipmap (section 6.2)."""

from collections.abc import Sequence

import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, Wrap, as_progress, set_options
from .._border.arrays import FloatArray
from .._border.samples import SAMPLE_CHECKS, as_coordinates, as_pyramid, as_samples, as_scales
from .sampling_table import SamplingTable


def sample(
    levels: Sequence[npt.ArrayLike],
    table: SamplingTable | str,
    coordinates: npt.ArrayLike,
    scales: npt.ArrayLike,
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FloatArray:
    """Samples of a mipmap under the filter of a table, from few texels each.

    The filter is `scale` times as wide as for the texels of level 0. A sample is the weighted sum
    of the table's number of texels, from the two levels around the scale and the next finer one;
    the weights depend on position and scale (section 6.2). With "trilinear" it is the usual
    interpolation between two levels instead.

    Samples of bytes are as accurate as those of floats: nothing is rounded in between. Colors must
    be multiplied by alpha before they are filtered; see `sampling_levels`.

    Args:
        levels: Level 0 first, from `sampling_levels` or `mipmaps`: arrays of shape (height, width,
            channels) or (height, width), floats, uint8 (divided by 255) or uint16 (divided by
            65535). Each has half the sides of the previous one, rounded up or down.
        table: The table, or "trilinear". The levels must be made with its filter; levels that store
            theirs (`FilteredLevels`) are checked.
        coordinates: (n, 2), u and v of each sample; the image spans 0 to 1 along both, row 0 at
            v = 0.
        scales: (n,), or one number for all: the width of the filter's unit in texels of level 0,
            at least 0. Scales below 1, which magnify, count as 1; scales beyond the last level, as
            that level's.
        wrap: Texels outside of the image: "clamp" (the nearest texel), "repeat" or "border" (zero),
            or a pair of these for u and v.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        The samples, float32 (n, channels), or (n,) if the levels are (height, width).

    Raises:
        ValueError: An argument is out of range, or the levels store the name of another filter.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.SampleOptions(), SAMPLE_CHECKS, locals())
    pyramid = as_pyramid(levels)
    places = as_coordinates(coordinates)
    samples = _native.sample(
        pyramid,
        native_table(table, levels),
        places,
        as_scales(scales, len(places)).reshape(-1),
        options,
        as_progress(progress),
    )
    return as_samples(levels, samples)


def native_table(
    table: SamplingTable | str, levels: Sequence[npt.ArrayLike]
) -> _native.SamplingTable | None:
    """Returns the native table for sampling these levels; None for "trilinear".

    Raises:
        ValueError: It is no table, or the levels store the name of another filter.
    """
    if isinstance(table, str) and table == "trilinear":
        return None
    if not isinstance(table, SamplingTable):
        raise ValueError(f"table: {table!r}; a SamplingTable is needed, or 'trilinear'")
    filter = getattr(levels, "filter", None)
    if filter not in (None, table.filter):
        raise ValueError(
            f"table: it is for levels of '{table.filter}', and these are filtered by '{filter}';"
            " both must be the same"
        )
    return table._native
