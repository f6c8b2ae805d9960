# SPDX-License-Identifier: GPL-3.0-or-later

"""Normals for the shading of surfaces with large triangles beside small ones.

Blender weights the faces around a vertex by their angles there, so that a large flat face is shaded
round where it borders on a rounded edge. Weighted by their areas, it stays flat.
"""

import math

import numpy as np
import prefilter
from numpy.typing import NDArray

_TINY = 1e-30
_MAX_FACET_DEVIATION = math.radians(0.1)
"""Greatest angle between a facet of a result and that of its source."""


def sharp_angle(angle: float) -> float:
    """Lowers the angle of sharp edges a little, so that edges of exactly that angle are sharp.

    The sides of a prism with twelve sides meet at exactly 30 degrees: rounding would make some
    edges smooth, and others sharp.
    """
    return angle if angle >= math.pi else max(angle - _MAX_FACET_DEVIATION, 0.0)


def weighted_normals(
    positions: NDArray[np.float32],
    triangles: NDArray[np.int32],
    edges: "prefilter.MeshEdges",
    sharp_angle: float,
) -> NDArray[np.float32]:
    """Area-weighted normals of corners, (3 m, 3).

    Args:
        positions: (n, 3).
        triangles: (m, 3) of a closed surface, counter-clockwise from outside.
        edges: Its edges.
        sharp_angle: Angle between two faces above which they share no normal, in radians.
    """
    a, b, c = np.moveaxis(positions.astype(np.float64)[triangles], 1, 0)
    areas = np.cross(b - a, c - a)
    fans = _fans(edges, _is_smooth(areas, edges, sharp_angle))
    shares = np.repeat(areas, 3, axis=0)
    sums = np.stack([np.bincount(fans, shares[:, axis]) for axis in range(3)], axis=1)
    normals = sums[fans]
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.maximum(lengths, _TINY), np.float32)


def _pairs(edges: "prefilter.MeshEdges") -> NDArray[np.int64]:
    """The two corners, one per face, from which each edge starts: (e, 2)."""
    corners = edges.corners.ravel()
    return np.argsort(corners, kind="stable").reshape(-1, 2)


def _is_smooth(
    areas: NDArray[np.float64], edges: "prefilter.MeshEdges", sharp_angle: float
) -> NDArray[np.bool_]:
    """Whether the faces of each edge share normals."""
    lengths = np.linalg.norm(areas, axis=1, keepdims=True)
    first, second = (areas / np.maximum(lengths, _TINY))[_pairs(edges) // 3].swapaxes(0, 1)
    return np.einsum("ij,ij->i", first, second) >= np.cos(sharp_angle)


def _fans(edges: "prefilter.MeshEdges", is_smooth: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Numbers the corners; those around a vertex that share a normal have the same number."""
    first, second = _pairs(edges)[is_smooth].T
    count = edges.corners.size
    before, after = np.arange(count), np.arange(count)
    # An edge runs in opposite directions in its two faces.
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
    """Next corner of each corner's triangle."""
    return np.where(corners % 3 == 2, corners - 2, corners + 1)
