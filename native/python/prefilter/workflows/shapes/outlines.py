# SPDX-License-Identifier: GPL-3.0-or-later

"""Conversion of rational Bezier curves in the plane to contours of `prefilter.Shape`."""

from math import comb

import numpy as np
from numpy.typing import NDArray

import prefilter

from ..matrices import product

FloatArray = NDArray[np.float64]

_PIECES = 32
"""Number of cubic curves that replace a rational one of degree above 2; the error of a quarter
circle is then 1e-8 of its radius."""
_SAMPLES = 64
"""Number of samples per curve for its box, which is exact to 1e-5 of the curve's size."""
_EQUAL = 1e-12


def add_contour(shape: "prefilter.Shape", control: FloatArray) -> None:
    """Adds a closed contour to a shape.

    Lines, polynomial curves and conics stay exact; rational curves of higher degree become cubic
    ones with the same tangents.

    Args:
        shape: The shape that gets the contour.
        control: (segments, degree + 1, 3) homogeneous control points, each segment starting at the
            end of the previous one: coordinates times the weight, then the weight, which is > 0.
    """
    points, weights = control[..., :2] / control[..., 2:], control[..., 2]
    degree = control.shape[1] - 1
    if degree == 1:
        shape.add_polygon(points[:, 0])
    elif np.ptp(weights) <= _EQUAL * weights.max():
        shape.add_beziers(_joined(points))
    elif degree == 2:
        shape.move_to(*points[0, 0])
        for (_, middle, end), (first, second, third) in zip(points, weights, strict=True):
            weight = float(second / np.sqrt(first * third))
            shape.conic_to(middle[0], middle[1], weight, end[0], end[1])
        shape.close()
    else:
        shape.add_beziers(_joined(_cubics(control)))


def box_of(control: FloatArray) -> FloatArray:
    """Returns the low and the high corner, (2, 2), of curves in the form of `add_contour`."""
    count = 2 if control.shape[1] == 2 else _SAMPLES + 1
    values = product(_bernstein(control.shape[1] - 1, count), control)
    points = values[..., :2] / values[..., 2:]
    return np.stack([points.min(axis=(0, 1)), points.max(axis=(0, 1))])


def _joined(points: FloatArray) -> FloatArray:
    """Returns curves that start exactly at the end of the previous one, in spite of rounding."""
    joined = points.copy()
    joined[1:, 0] = points[:-1, -1]
    return joined


def _cubics(control: FloatArray) -> FloatArray:
    """Returns cubic curves through points of rational curves, with the same tangents there."""
    degree = control.shape[1] - 1
    values = product(_bernstein(degree, _PIECES + 1), control)
    slopes = product(_bernstein(degree - 1, _PIECES + 1), degree * np.diff(control, axis=1))
    points = values[..., :2] / values[..., 2:]
    tangents = (slopes[..., :2] - points * slopes[..., 2:]) / values[..., 2:] / (3 * _PIECES)
    start, end = points[:, :-1], points[:, 1:]
    pieces = np.stack([start, start + tangents[:, :-1], end - tangents[:, 1:], end], axis=2)
    return pieces.reshape(-1, 4, 2)


def _bernstein(degree: int, count: int) -> FloatArray:
    """Returns (count, degree + 1) values of Bernstein polynomials, evenly spaced over [0, 1]."""
    t = np.linspace(0.0, 1.0, count)[:, None]
    k = np.arange(degree + 1)
    binomials = np.array([comb(degree, i) for i in k], np.float64)
    return binomials * t**k * (1.0 - t) ** (degree - k)
