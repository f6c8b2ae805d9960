# SPDX-License-Identifier: GPL-3.0-or-later

"""Conversion of arguments: points, colors, matrices and gradient stops."""

from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from .._border.arguments import as_number
from .._border.arrays import as_array, as_floats

Stop = tuple[float, Sequence[float]]
_MAX_CHANNELS = 4


def as_color(name: str, color: Sequence[float]) -> tuple[float, ...]:
    array = as_array(name, color)
    if array.ndim != 1 or not 1 <= array.size <= _MAX_CHANNELS or array.dtype.kind not in "fiu":
        raise ValueError(f"{name}: {color!r}; one to {_MAX_CHANNELS} numbers are needed")
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: {color!r}; finite numbers are needed")
    return tuple(float(value) for value in array)


def as_point(name: str, point: Sequence[float]) -> tuple[float, float]:
    array = as_array(name, point)
    if array.shape != (2,) or array.dtype.kind not in "fiu" or not np.isfinite(array).all():
        raise ValueError(f"{name}: {point!r}; a pair of finite numbers is needed")
    return float(array[0]), float(array[1])


def as_points(name: str, points: npt.ArrayLike, shape: Sequence[int | str]) -> np.ndarray:
    return as_floats(name, points, shape, np.float64)


def check_finite(name: str, points: np.ndarray) -> None:
    if not np.isfinite(points).all():
        raise ValueError(f"{name}: a coordinate is not finite")


def as_matrix(name: str, matrix: npt.ArrayLike) -> list[float]:
    array = as_array(name, matrix)
    if array.shape != (2, 3) or array.dtype.kind not in "fiu" or not np.isfinite(array).all():
        raise ValueError(f"{name}: shape {array.shape}; (2, 3) of finite numbers is needed")
    numbers = [float(number) for number in array.ravel()]
    if determinant(numbers) == 0.0:
        raise ValueError(f"{name}: maps the plane to a line; a matrix of rank 2 is needed")
    return numbers


def determinant(matrix: Sequence[float]) -> float:
    return matrix[0] * matrix[4] - matrix[1] * matrix[3]


def as_stops(stops: Iterable[Stop]) -> list[tuple[float, list[float]]]:
    try:
        listed = [(offset, color) for offset, color in stops]
    except (TypeError, ValueError) as error:
        raise ValueError("stops: pairs (offset, color) are needed") from error
    if not listed:
        raise ValueError("stops: found none; at least one is needed")
    pairs: list[tuple[float, list[float]]] = []
    for offset, color in listed:
        number = as_number("stops: offset", offset)
        if not 0.0 <= number <= 1.0 or (pairs and number < pairs[-1][0]):
            raise ValueError(f"stops: offset {offset!r}; rising numbers in [0, 1] are needed")
        values = list(as_color("stops: color", color))
        if pairs and len(values) != len(pairs[0][1]):
            raise ValueError("stops: colors with as many values each are needed")
        pairs.append((number, values))
    return pairs
