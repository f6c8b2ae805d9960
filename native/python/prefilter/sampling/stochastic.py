# SPDX-License-Identifier: GPL-3.0-or-later

"""Stochastic samples of one texel each, correct on average, for renderers with many samples."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, Wrap, as_progress, set_options
from .._border.arrays import FloatArray, as_floats
from .._border.samples import SAMPLE_CHECKS, as_coordinates, as_pyramid, as_samples, as_scales
from .samples import native_table
from .sampling_table import SamplingTable


class PickedTexels(NamedTuple):
    """One texel for each sample.

    Attributes:
        texels: (n, 3) integers: level, column and row. Column or row are -1 outside of the image
            with the wrap mode "border", where texels are zero.
        weights: (n,): factors for the texels' values; negative for some texels of filters with
            negative lobes.
    """

    texels: npt.NDArray[np.int32]
    weights: npt.NDArray[np.float64]


def sample_stochastic(
    levels: Sequence[npt.ArrayLike],
    table: SamplingTable | str,
    coordinates: npt.ArrayLike,
    scales: npt.ArrayLike,
    numbers: npt.ArrayLike,
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FloatArray:
    """Samples of a mipmap that read one texel each, with the result of `sample` as their mean.

    One of the table's texels for a position and scale is chosen with a probability proportional to
    the magnitude of its weight, and multiplied by the sum of all magnitudes, with the sign of its
    weight. Negative weights cause noise proportional to the values: subtract a constant near their
    mean from the levels, and add it to the samples.

    Args:
        levels: As for `sample`.
        table: As for `sample`; also "bilinear": interpolation in the level next to the scale.
        coordinates: As for `sample`.
        scales: As for `sample`.
        numbers: (n,), random numbers in [0, 1), one per sample. Evenly distributed numbers, such as
            stratified ones, reduce noise.
        wrap: As for `sample`.
        progress: As for `sample`.
        threads: As for `sample`.

    Returns:
        The samples, float32 (n, channels), or (n,) if the levels are (height, width).

    Raises:
        ValueError: An argument is out of range, or the levels store the name of another filter.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.SampleOptions(), SAMPLE_CHECKS, locals())
    places = _places(levels, table, coordinates, scales, numbers)
    samples = _native.sample_stochastic(*places, options, as_progress(progress))
    return as_samples(levels, samples)


def pick_texels(
    levels: Sequence[npt.ArrayLike],
    table: SamplingTable | str,
    coordinates: npt.ArrayLike,
    scales: npt.ArrayLike,
    numbers: npt.ArrayLike,
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> PickedTexels:
    """Returns the texels that `sample_stochastic` reads, for renderers that filter after shading.

    Such a renderer shades with the unmodified texel, and multiplies the result by the weight.

    Args:
        levels: As for `sample_stochastic`; only their sizes count.
        table: As for `sample_stochastic`.
        coordinates: As for `sample_stochastic`.
        scales: As for `sample_stochastic`.
        numbers: As for `sample_stochastic`.
        wrap: As for `sample_stochastic`.
        progress: As for `sample_stochastic`.
        threads: As for `sample_stochastic`.

    Raises:
        ValueError: An argument is out of range, or the levels store the name of another filter.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.SampleOptions(), SAMPLE_CHECKS, locals())
    places = _places(levels, table, coordinates, scales, numbers)
    return PickedTexels(*_native.pick_texels(*places, options, as_progress(progress)))


_Places = tuple[
    list[np.ndarray],
    _native.SamplingTable | None,
    bool,
    npt.NDArray[np.float64],
    npt.NDArray[np.float64],
    npt.NDArray[np.float64],
]


def _places(
    levels: Sequence[npt.ArrayLike],
    table: SamplingTable | str,
    coordinates: npt.ArrayLike,
    scales: npt.ArrayLike,
    numbers: npt.ArrayLike,
) -> _Places:
    """Returns the checked arguments of the native functions."""
    pyramid = as_pyramid(levels)
    places = as_coordinates(coordinates)
    bilinear = isinstance(table, str) and table == "bilinear"
    return (
        pyramid,
        None if bilinear else native_table(table, levels),
        bilinear,
        places,
        as_scales(scales, len(places)).reshape(-1),
        as_floats("numbers", numbers, (len(places),), np.float64),
    )
