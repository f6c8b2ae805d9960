# SPDX-License-Identifier: GPL-3.0-or-later

"""Faces that are triangles, or quads, which are cut from the first corner to the third."""

import numpy as np
import prefilter
from numpy.typing import NDArray

IntArray = NDArray[np.int32]

_HALVES = [[0, 1, 2], [0, 2, 3]]


def halves(faces: IntArray) -> IntArray:
    """Returns triangles as they are, and of quads both."""
    return faces if faces.shape[1] == 3 else faces[:, _HALVES].reshape(-1, 3)


def each_half(values: IntArray, faces: IntArray) -> IntArray:
    """Returns a value for each triangle of faces that have one each."""
    return values if faces.shape[1] == 3 else np.repeat(values, 2)


def corners_of(halved: IntArray, faces: IntArray) -> IntArray:
    """Returns what the corners of faces have, from what those of their triangles have."""
    if faces.shape[1] == 3:
        return halved
    pairs = halved.reshape(-1, 6)
    return np.ascontiguousarray(pairs[:, [0, 1, 2, 5]])


def face_edges(
    positions: NDArray[np.float32], faces: IntArray, threads: int
) -> "prefilter.MeshEdges":
    """Returns the edges of faces, without those within quads."""
    edges = prefilter.mesh_edges(positions, halves(faces), threads=threads)
    if faces.shape[1] == 3:
        return edges
    pairs = edges.corners.reshape(-1, 6)
    corners = pairs[:, [0, 1, 4, 5]]
    is_side = np.zeros(len(edges.vertices), bool)
    is_side[corners.ravel()] = True
    numbers = np.cumsum(is_side, dtype=np.int32) - 1
    return prefilter.MeshEdges(edges.vertices[is_side], numbers[corners].astype(np.int32))
