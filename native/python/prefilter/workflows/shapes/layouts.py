# SPDX-License-Identifier: GPL-3.0-or-later

"""Borders of the area that triangles cover in a plane, as closed polygons."""

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def borders(triangles: NDArray[np.float32]) -> list[FloatArray]:
    """Returns closed polygons whose winding number at a point is the number of triangles there.

    Args:
        triangles: (m, 3, 2) corners, in either orientation.
    """
    u, v = (triangles[:, k].astype(np.float64) - triangles[:, 0] for k in (1, 2))
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    turned = np.where((area < 0.0)[:, None, None], triangles[:, ::-1], triangles)[area != 0.0]
    if len(turned) == 0:
        return []
    # Adding 0 turns -0 into 0, so that equal positions have equal bits.
    bits = np.ascontiguousarray(turned + np.float32(0.0)).view(np.uint64).reshape(-1)
    places, index = np.unique(bits, return_inverse=True)
    index = index.reshape(-1, 3)
    start, end = index.ravel(), np.roll(index, -1, axis=1).ravel()
    # An edge that two triangles traverse in opposite directions is no border.
    low, high = np.minimum(start, end), np.maximum(start, end)
    edges, of_edge = np.unique(low * len(places) + high, return_inverse=True)
    net = np.bincount(of_edge.ravel(), np.where(start < end, 1, -1)).astype(np.int64)
    edges, net = edges[net != 0], net[net != 0]
    low, high = edges // len(places), edges % len(places)
    start = np.repeat(np.where(net > 0, low, high), np.abs(net))
    end = np.repeat(np.where(net > 0, high, low), np.abs(net))
    points = places.view(np.float32).reshape(-1, 2).astype(np.float64)
    return [points[loop] for loop in _loops(start.tolist(), end.tolist())]


def _loops(starts: list[int], ends: list[int]) -> list[list[int]]:
    """Returns closed walks along directed edges; each vertex has equal in- and out-degree."""
    onward: dict[int, list[int]] = defaultdict(list)
    for start, end in zip(starts, ends, strict=True):
        onward[start].append(end)
    loops = []
    for first in starts:
        while onward[first]:
            walk, place = [first], onward[first].pop()
            while place != first:
                walk.append(place)
                place = onward[place].pop()
            loops.append(walk)
    return loops
