# SPDX-License-Identifier: GPL-3.0-or-later

"""Marks of edges and vertices, transferred from the sources of a surface to it."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge.marks import MarkKind, Marks, NewMarks

_REACH_CELLS = 0.1
"""Greatest distance between an edge or vertex and its source, in cells."""
_ALONG_MIN_COSINE = 0.97
"""Least cosine between an edge and the source edge that it lies on."""

FloatArray = NDArray[np.float64]
Values = NDArray[Any]


def carried_marks(
    marks: Sequence[Marks],
    positions: FloatArray,
    edges: "prefilter.MeshEdges",
    cell: float,
    threads: int,
) -> list[NewMarks]:
    """Transfers marks to a surface.

    Args:
        marks: Marks of the sources.
        positions: (n, 3), vertices of the surface, in the space of the marks.
        edges: Edges of the surface.
        cell: Side of a cell.
        threads: Number of threads; 0 for all processors.
    """
    return [
        NewMarks(kind, values)
        for kind, values in _carried(marks, positions, edges, _REACH_CELLS * cell, threads)
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
    for each in marks:
        kinds.setdefault(each.kind.name, each.kind)
    for kind in kinds.values():
        of_kind = [each for each in marks if each.kind == kind]
        ends = np.concatenate([each.ends for each in of_kind]).astype(np.float64)
        values = np.concatenate([each.values for each in of_kind])
        if kind.domain == "POINT":
            yield kind, _vertex_values(ends[:, 0], values, positions, reach, threads)
        else:
            yield kind, _edge_values(ends, values, positions, edges, reach, threads)


def _nearest(
    points: FloatArray, ends: FloatArray, threads: int
) -> tuple[NDArray[np.int64], FloatArray]:
    """Nearest segment of each point, and its distance."""
    first = 2 * np.arange(len(ends))
    segments, _, distances = prefilter.nearest_points(
        points,
        ends.reshape(-1, 3),
        np.stack([first, first + 1, first + 1], axis=1),
        threads=threads,
    )
    return segments.astype(np.int64), distances


def _vertex_values(
    marked: FloatArray,
    values: Values,
    positions: FloatArray,
    reach: float,
    threads: int,
) -> Values:
    """Values of vertices: the vertex nearest to each marked position gets its value."""
    nearest, distances = _nearest(positions, np.stack([marked, marked], axis=1), threads)
    near = np.flatnonzero(distances <= reach)
    order = near[np.argsort(distances[near], kind="stable")]
    _, firsts = np.unique(nearest[order], return_index=True)
    chosen = order[firsts]
    result = np.zeros((len(positions), values.shape[1]), values.dtype)
    result[chosen] = values[nearest[chosen]]
    return result


def _edge_values(
    ends: FloatArray,
    values: Values,
    positions: FloatArray,
    edges: "prefilter.MeshEdges",
    reach: float,
    threads: int,
) -> Values:
    """Values of edges: an edge that lies on a marked one gets its value."""
    _, distances = _nearest(positions, ends, threads)
    is_near = distances <= reach
    candidates = np.flatnonzero(is_near[edges.vertices].all(axis=1))
    result = np.zeros((len(edges.vertices), values.shape[1]), values.dtype)
    if not len(candidates):
        return result
    a, b = np.moveaxis(positions[edges.vertices[candidates]], 1, 0)
    nearest, distances = _nearest((a + b) / 2.0, ends, threads)
    along, source = b - a, ends[nearest, 1] - ends[nearest, 0]
    lengths = np.linalg.norm(along, axis=1) * np.linalg.norm(source, axis=1)
    is_along = np.abs(np.einsum("ij,ij->i", along, source)) >= _ALONG_MIN_COSINE * lengths
    lies = is_along & (distances <= reach)
    result[candidates[lies]] = values[nearest[lies]]
    return result
