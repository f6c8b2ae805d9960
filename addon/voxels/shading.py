# SPDX-License-Identifier: GPL-3.0-or-later

"""Normals by which large triangles beside small ones shade as the surface that they stand for.

Blender weights the faces around a vertex by their angles there, so that a large flat face is shaded
round where it borders on a rounded edge. Weighted by their areas, it stays flat.
"""

import math

import numpy as np
import prefilter
from numpy.typing import NDArray

_HELD = 1e-30
_SLACK = math.radians(0.1)
"""By so much facets of results are off those of the source, at most."""


def sharp_angle(angle: float) -> float:
    """Returns the angle beyond which edges are sharp, so that those that turn by `angle` are too.

    The sides of a prism of twelve sides meet at just 30 degrees: rounding would make some edges
    smooth, and others sharp.
    """
    return angle if angle >= math.pi else max(angle - _SLACK, 0.0)


def weighted_normals(
    positions: NDArray[np.float32],
    triangles: NDArray[np.int32],
    edges: "prefilter.MeshEdges",
    sharp_angle: float,
) -> NDArray[np.float32]:
    """Returns the normals of corners, (3 m, 3), by the areas of the faces around them.

    Args:
        positions: (n, 3).
        triangles: (m, 3) of a closed surface, counter-clockwise from outside.
        edges: Its edges.
        sharp_angle: Where the normals of two faces differ by more, in radians, none is shared.
    """
    a, b, c = np.moveaxis(positions.astype(np.float64)[triangles], 1, 0)
    areas = np.cross(b - a, c - a)
    fans = _fans(edges, _is_smooth(areas, edges, sharp_angle))
    shares = np.repeat(areas, 3, axis=0)
    sums = np.stack([np.bincount(fans, shares[:, axis]) for axis in range(3)], axis=1)
    normals = sums[fans]
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.maximum(lengths, _HELD), np.float32)


def _pairs(edges: "prefilter.MeshEdges") -> NDArray[np.int64]:
    """Returns the two corners, one of each face, from which each edge runs: (e, 2)."""
    corners = edges.corners.ravel()
    return np.argsort(corners, kind="stable").reshape(-1, 2)


def _is_smooth(
    areas: NDArray[np.float64], edges: "prefilter.MeshEdges", sharp_angle: float
) -> NDArray[np.bool_]:
    """Returns for each edge whether its faces share normals."""
    lengths = np.linalg.norm(areas, axis=1, keepdims=True)
    first, second = (areas / np.maximum(lengths, _HELD))[_pairs(edges) // 3].swapaxes(0, 1)
    return np.einsum("ij,ij->i", first, second) >= np.cos(sharp_angle)


def _fans(edges: "prefilter.MeshEdges", is_smooth: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Returns a number for each corner; those around a vertex that share a normal have the same."""
    first, second = _pairs(edges)[is_smooth].T
    count = edges.corners.size
    before, after = np.arange(count), np.arange(count)
    # Around the vertex where the edge begins in one face it ends in the other.
    before[first], after[_next(second)] = _next(second), first
    before[second], after[_next(first)] = _next(first), second
    fans = np.arange(count)
    while True:
        lower = np.minimum(fans, np.minimum(fans[before], fans[after]))
        lower = lower[lower]
        if np.array_equal(lower, fans):
            return fans
        fans = lower


def _next(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns the corners of the same faces that follow."""
    return np.where(corners % 3 == 2, corners - 2, corners + 1)
