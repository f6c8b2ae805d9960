# SPDX-License-Identifier: GPL-3.0-or-later

"""Conversion of Blender's NURBS curves to rational Bezier curves, by knot insertion."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def bezier_segments(
    points: FloatArray, order: int, *, cyclic: bool, endpoint: bool, bezier: bool
) -> FloatArray:
    """Splits a curve into Bezier segments of the same shape.

    Args:
        points: (n, c) homogeneous control points: coordinates multiplied by the weight, then the
            weight.
        order: Degree + 1; at most n.
        cyclic: Whether the curve is closed.
        endpoint: Whether it reaches its end points.
        bezier: Whether it has the knots of a chain of Bezier curves.

    Returns:
        (segments, order, c) homogeneous control points of Bezier curves, one after the other.
    """
    degree = order - 1
    knots = _knots(len(points), order, cyclic=cyclic, endpoint=endpoint, bezier=bezier)
    control = np.concatenate([points, points[:degree]]) if cyclic else points
    spans = [j for j in range(degree, len(control)) if knots[j + 1] > knots[j]]
    segments = np.empty((len(spans), order, points.shape[1]))
    for segment, j in zip(segments, spans, strict=True):
        for k in range(order):
            arguments = [knots[j]] * (degree - k) + [knots[j + 1]] * k
            segment[k] = _blossom(control[j - degree : j + 1], knots, j, arguments)
    return segments


def _knots(count: int, order: int, *, cyclic: bool, endpoint: bool, bezier: bool) -> FloatArray:
    """Knots of a curve in Blender (calcknots in its source)."""
    inner = order - 1 if bezier else 1
    head = (order - (1 if cyclic else 0)) if endpoint else (min(2, inner) if bezier else 1)
    tail = 2 * order - 1 if cyclic else (order if endpoint else 0)
    knots = np.zeros(count + order + (order - 1 if cyclic else 0))
    first = 1 if endpoint and cyclic else 0
    current, repeats = float(first), head
    for i in range(first, len(knots) - tail):
        knots[i] = current
        repeats -= 1
        if repeats == 0:
            current += 1.0
            repeats = inner
    for i in range(tail):
        knots[len(knots) - tail + i] = current + (knots[i] - knots[0])
    return knots


def _blossom(
    control: FloatArray, knots: FloatArray, j: int, arguments: Sequence[float]
) -> FloatArray:
    """Polar form of the polynomial on span j (Ramshaw, 1987), by de Boor's scheme.

    If all arguments are the first or the second knot of the span, it is a Bezier control point.
    """
    degree = len(control) - 1
    points = control.copy()
    for level, value in enumerate(arguments, start=1):
        for i in range(degree, level - 1, -1):
            low, high = knots[j - degree + i], knots[j + i + 1 - level]
            share = (value - low) / (high - low)
            points[i] = (1.0 - share) * points[i - 1] + share * points[i]
    return points[degree]
