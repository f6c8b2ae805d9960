# SPDX-License-Identifier: GPL-3.0-or-later

"""Triangles and quads; the diagonal of a quad is from its first corner to its third."""

import numpy as np
import prefilter
from numpy.typing import NDArray

IntArray = NDArray[np.int32]

_HALVES = [[0, 1, 2], [0, 2, 3]]


def halves(faces: IntArray) -> IntArray:
    """Splits quads into triangles; returns triangles unchanged."""
    return faces if faces.shape[1] == 3 else faces[:, _HALVES].reshape(-1, 3)


def each_half(values: IntArray, faces: IntArray) -> IntArray:
    """Converts per-face values to per-triangle values."""
    return values if faces.shape[1] == 3 else np.repeat(values, 2)


def corners_of(halved: IntArray, faces: IntArray) -> IntArray:
    """Converts per-triangle-corner values to per-face-corner values."""
    if faces.shape[1] == 3:
        return halved
    pairs = halved.reshape(-1, 6)
    return np.ascontiguousarray(pairs[:, [0, 1, 2, 5]])


def face_edges(
    positions: NDArray[np.float32], faces: IntArray, threads: int
) -> "prefilter.MeshEdges":
    """Edges of faces, without the diagonals of quads."""
    edges = prefilter.mesh_edges(positions, halves(faces), threads=threads)
    if faces.shape[1] == 3:
        return edges
    pairs = edges.corners.reshape(-1, 6)
    corners = pairs[:, [0, 1, 4, 5]]
    is_side = np.zeros(len(edges.vertices), bool)
    is_side[corners.ravel()] = True
    numbers = np.cumsum(is_side, dtype=np.int32) - 1
    return prefilter.MeshEdges(edges.vertices[is_side], numbers[corners].astype(np.int32))
