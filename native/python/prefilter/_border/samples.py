# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of mipmap levels and of sample positions."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .arguments import Check, as_int, as_items, as_wrap
from .arrays import (
    FloatArray,
    as_array,
    as_floats,
    as_image,
    as_texels,
    as_threads,
    check_shape,
    in_form_of,
)

SAMPLE_CHECKS: dict[str, Check] = {"wrap": as_wrap, "threads": as_threads}
"""Checks of the arguments that all sampling functions share."""


def as_pyramid(levels: Sequence[npt.ArrayLike]) -> list[np.ndarray]:
    """Returns levels, level 0 first: all float32 or all uint8, with equally many channels.

    Types other than uint8 become float32.
    """
    if not isinstance(levels, Sequence) or isinstance(levels, str | bytes):
        raise ValueError(f"levels: a {type(levels).__name__}; a list of arrays is needed")
    checked = [
        _as_level(f"levels: level {k}", level)
        for k, level in enumerate(as_items("levels", levels, "a list of images"))
    ]
    for k, level in enumerate(checked):
        if (level.dtype, level.shape[2]) != (checked[0].dtype, checked[0].shape[2]):
            raise ValueError(
                f"levels: level {k} has {level.shape[2]} channels of {level.dtype}; as level 0 has,"
                f" {checked[0].shape[2]} of {checked[0].dtype} are needed"
            )
    return checked


def _as_level(name: str, level: npt.ArrayLike) -> np.ndarray:
    texels = as_texels(name, level)
    return texels if texels.dtype == np.uint8 else as_image(name, texels)


def as_samples(levels: Sequence[npt.ArrayLike], samples: FloatArray) -> FloatArray:
    """Returns samples (n, channels); (n,) if the levels have no axis of channels."""
    return in_form_of(levels[0], samples)


def as_coordinates(coordinates: npt.ArrayLike) -> npt.NDArray[np.float64]:
    return as_floats("coordinates", coordinates, ("samples", 2), np.float64)


def as_scales(scales: npt.ArrayLike, samples: int) -> npt.NDArray[np.float64]:
    """Returns a scale for each sample, or a single one for all."""
    values = as_array("scales", scales)
    if values.dtype.kind not in "iuf":
        raise ValueError(f"scales: dtype {values.dtype}; numbers are needed")
    if values.ndim > 0:
        check_shape("scales", values, (samples,))
    return np.ascontiguousarray(values, np.float64)


def as_jacobians(jacobians: npt.ArrayLike, samples: int) -> npt.NDArray[np.float64]:
    return as_floats("jacobians", jacobians, (samples, 2, 2), np.float64)


def as_probe_count(max_probes: int) -> int:
    return as_int("max_probes", max_probes, "a whole number from 1 to 256 is needed")
