# SPDX-License-Identifier: GPL-3.0-or-later

"""Which edges and vertices of a surface lie where those of its sources were marked."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge.marks import MarkKind, Marks, NewMarks

_REACH = 0.1
"""In cells, of edges and vertices from what they stand for."""
_ALONG = 0.97
"""Least cosine between an edge and what it lies on."""

FloatArray = NDArray[np.float64]
Values = NDArray[Any]


def carried_marks(
    marks: Sequence[Marks],
    positions: FloatArray,
    edges: "prefilter.MeshEdges",
    cell: float,
    threads: int,
) -> list[NewMarks]:
    """Returns what a surface gets of its sources' marks.

    Args:
        marks: Of the sources.
        positions: (n, 3) of the surface, in the space of the marks.
        edges: Its edges.
        cell: The side of a cell.
        threads: How many, or 0.
    """
    return [
        NewMarks(kind, values)
        for kind, values in _carried(marks, positions, edges, _REACH * cell, threads)
        if values.any()
    ]


def _carried(
    marks: Sequence[Marks],
    positions: FloatArray,
    edges: "prefilter.MeshEdges",
    reach: float,
    threads: int,
) -> Iterator[tuple[MarkKind, Values]]:
    kinds: dict[str, MarkKind] = {}
    for one in marks:
        kinds.setdefault(one.kind.name, one.kind)
    for kind in kinds.values():
        of_kind = [one for one in marks if one.kind == kind]
        ends = np.concatenate([one.ends for one in of_kind]).astype(np.float64)
        values = np.concatenate([one.values for one in of_kind])
        if kind.domain == "POINT":
            yield kind, _of_vertices(ends[:, 0], values, positions, reach, threads)
        else:
            yield kind, _of_edges(ends, values, positions, edges, reach, threads)


def _nearest(
    points: FloatArray, ends: FloatArray, threads: int
) -> tuple[NDArray[np.int64], FloatArray]:
    """Returns the nearest segment of each point, and how far it is."""
    first = 2 * np.arange(len(ends))
    found = prefilter.nearest_points(
        points,
        ends.reshape(-1, 3),
        np.stack([first, first + 1, first + 1], axis=1),
        threads=threads,
    )
    return found[0].astype(np.int64), found[2]


def _of_vertices(
    places: FloatArray,
    values: Values,
    positions: FloatArray,
    reach: float,
    threads: int,
) -> Values:
    """Returns values of vertices: the nearest one to each marked place has that of the place."""
    nearest, distances = _nearest(positions, np.stack([places, places], axis=1), threads)
    near = np.flatnonzero(distances <= reach)
    order = near[np.argsort(distances[near], kind="stable")]
    _, firsts = np.unique(nearest[order], return_index=True)
    chosen = order[firsts]
    result = np.zeros((len(positions), values.shape[1]), values.dtype)
    result[chosen] = values[nearest[chosen]]
    return result


def _of_edges(
    ends: FloatArray,
    values: Values,
    positions: FloatArray,
    edges: "prefilter.MeshEdges",
    reach: float,
    threads: int,
) -> Values:
    """Returns values of edges: those that lie on marked ones have theirs."""
    _, distances = _nearest(positions, ends, threads)
    is_near = distances <= reach
    candidates = np.flatnonzero(is_near[edges.vertices].all(axis=1))
    result = np.zeros((len(edges.vertices), values.shape[1]), values.dtype)
    if not len(candidates):
        return result
    a, b = np.moveaxis(positions[edges.vertices[candidates]], 1, 0)
    nearest, distances = _nearest((a + b) / 2.0, ends, threads)
    along, of = b - a, ends[nearest, 1] - ends[nearest, 0]
    lengths = np.linalg.norm(along, axis=1) * np.linalg.norm(of, axis=1)
    is_along = np.abs(np.einsum("ij,ij->i", along, of)) >= _ALONG * lengths
    lies = is_along & (distances <= reach)
    result[candidates[lies]] = values[nearest[lies]]
    return result
