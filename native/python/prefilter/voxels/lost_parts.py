# SPDX-License-Identifier: GPL-3.0-or-later

"""Detection of mesh parts that vanish in voxelization."""

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import as_progress

_STEPS = (0.0, -0.5, 0.5, -1.0, 1.0)
"""Distances at which leaves are probed, in cells along the normal."""
_SPACING = 0.25
"""Distance between sample points on parts that may be lost, in cells."""
_MOST_STEPS = 64
"""Largest number of sample steps along a triangle's side."""
_INSIDE = 0.5


def find_lost_parts(
    octree: _native.Octree,
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    part_of: npt.NDArray[np.int32],
    threads: int,
) -> npt.NDArray[np.int64]:
    """Returns the parts without a triangle inside of an octree's shape or within a cell of it."""
    low, high = (np.array(corner) for corner in octree.bounds)
    cell = float(((high - low) / 2.0**octree.depth).max())
    # The first triangles suffice to decide most parts.
    highest = np.maximum.accumulate(part_of)
    first = np.flatnonzero(highest[1:] > highest[:-1]) + 1
    if len(part_of) and part_of[0] >= 0:
        first = np.insert(first, 0, 0)
    count = int(highest[-1]) + 1 if len(highest) else 0
    is_open = np.ones(max(count, 1), bool)  # Parts that are not known to be preserved.
    if len(first) < max(count, 1):
        is_open[:] = False
        is_open[part_of[part_of >= 0]] = True
    for is_first in (True, False):
        chosen = first if is_first else _triangles_of(is_open, part_of)
        corners = positions[triangles[chosen]].astype(np.float64)
        points = _probes(corners, cell)
        values = _native.values_at(octree, points.reshape(-1, 3), threads)
        is_kept = (values.reshape(len(chosen), len(_STEPS)) >= _INSIDE).any(axis=1)
        # Triangles beyond the bounds were cut off, not lost.
        is_kept |= ((corners.max(axis=1) < low) | (corners.min(axis=1) > high)).any(axis=1)
        is_open[part_of[chosen[is_kept]]] = False
        if not is_open.any():
            return np.empty(0, np.int64)
    doubtful = _triangles_of(is_open, part_of)
    if len(doubtful):
        near = _nearest(octree, positions[triangles[doubtful]].astype(np.float64), cell, threads)
        is_open[part_of[doubtful[near <= cell]]] = False
    return np.flatnonzero(is_open)


def _triangles_of(
    is_chosen: npt.NDArray[np.bool_], part_of: npt.NDArray[np.int32]
) -> npt.NDArray[np.int64]:
    """Returns the triangles of the chosen parts."""
    return np.flatnonzero((part_of >= 0) & is_chosen[part_of])


def _lengths(vectors: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Returns the lengths of vectors along the last axis."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    lengths: npt.NDArray[np.float64] = np.sqrt(x * x + y * y + z * z)
    return lengths


def _probes(corners: npt.NDArray[np.float64], cell: float) -> npt.NDArray[np.float64]:
    """Returns points around the centroids of triangles: (triangles, steps, 3)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = _lengths(normals)[:, None]
    normals = normals / np.where(lengths > 0.0, lengths, 1.0) * cell
    middles = corners.mean(axis=1)
    return np.stack([middles + step * normals for step in _STEPS], axis=1)


def _nearest(
    octree: _native.Octree, corners: npt.NDArray[np.float64], cell: float, threads: int
) -> npt.NDArray[np.float64]:
    """Returns the distances of triangles from a contour."""
    options = _native.ContourOptions()
    options.interpolant = "plane"
    options.cleanup = False
    options.threads = threads
    surface = _native.contour_octree(octree, [], options, as_progress(None))
    if len(surface[1]) == 0:
        return np.full(len(corners), np.inf)
    tree = _native.NearestPoints(*surface, as_progress(None), threads)
    longest = _lengths(corners - np.roll(corners, -1, axis=1)).max(axis=1)
    steps = np.clip(np.ceil(longest / (_SPACING * cell)), 1, _MOST_STEPS).astype(int)
    nearest = np.empty(len(corners))
    for step in np.unique(steps):
        chosen = np.flatnonzero(steps == step)
        i, j = np.meshgrid(np.arange(step + 1), np.arange(step + 1), indexing="ij")
        u, v = i[i + j <= step] / step, j[i + j <= step] / step
        a, b, c = (corners[chosen, k][:, None] for k in range(3))
        points = (1.0 - u - v)[:, None] * a + u[:, None] * b + v[:, None] * c
        distances = tree.find(points.reshape(-1, 3), as_progress(None), threads)[2]
        nearest[chosen] = distances.reshape(len(chosen), -1).min(axis=1)
    return nearest
