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

    The filter is `scale` times as wide as it is over the texels of level 0. A sample is the sum of
    as many texels as the table has, from the two levels around the scale and the one below them,
    weighted by what the table says for the place and the scale (section 6.2). With "trilinear" it
    is the usual interpolation between two levels instead.

    Samples of bytes are as exact as those of floats: nothing is rounded on the way. Color that is
    not multiplied by its alpha must be before it is filtered; see `sampling_levels`.

    Args:
        levels: Level 0 first, as `sampling_levels` or `mipmaps` returns them: arrays of shape
            (height, width, channels) or (height, width), floats, uint8 that stand for a 255th each
            or uint16 for a 65535th. Sides are half of those of the level before, rounded either
            way.
        table: What to sample with. The levels must be filtered by its filter; those that know
            theirs (`FilteredLevels`) are checked. Or "trilinear".
        coordinates: (n, 2), u and v of each sample; the image spans 0 to 1 along both, row 0 at
            v = 0.
        scales: (n,), or one number for all: the width of the filter's unit in texels of level 0,
            at least 0. A scale below 1, which magnifies, counts as 1; one beyond the last level as
            that level's.
        wrap: What lies outside of the image: "clamp" (its nearest texel), "repeat" or "border"
            (zero), or a pair of these for u and v.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        The samples, float32 (n, channels), or (n,) of levels (height, width).

    Raises:
        ValueError: An argument is out of range, or the levels are known to have another filter.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.SampleOptions(), SAMPLE_CHECKS, locals())
    pyramid = as_pyramid(levels)
    places = as_coordinates(coordinates)
    found = _native.sample(
        pyramid,
        native_table(table, levels),
        places,
        as_scales(scales, len(places)).reshape(-1),
        options,
        as_progress(progress),
    )
    return as_samples(levels, found)


def native_table(
    table: SamplingTable | str, levels: Sequence[npt.ArrayLike]
) -> _native.SamplingTable | None:
    """What a function that samples these levels by a table hands on; None for "trilinear".

    Raises:
        ValueError: It is no table, or the levels are known to be made with another filter.
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
