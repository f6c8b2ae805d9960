# SPDX-License-Identifier: GPL-3.0-or-later

"""Distinguishes folds of a result from edges at which the solid itself turns as far.

A solid's edges are its mesh's edges, with caps of holes and with equal vertices merged; groups of
close edges that turn to the same side; and the lines along which its triangles cross. Nothing here
calls the library.
"""

import numpy as np

from . import measures
from .measures import Floats, Indices
from .nearest import Nearest, to_segments

REACH = 0.25  # Cells between a fold and an edge of the solid.
SLACK = 20.0  # Degrees by which a fold may turn farther.
LEAST_BEND = 1.0  # Degrees: other edges are flat.
ASIDE = 0.02  # Cells from a crossing to the points tested for being inside.


def are_wedges(
    made: Floats,
    faces: Indices,
    folded: Indices,
    solid: tuple[Floats, Indices],
    cell: float,
) -> np.ndarray:
    """Whether pairs (n, 2) of triangles meet at an edge of the solid.

    They do where it has an edge within a quarter of a cell of the middle of theirs, convex or
    concave as theirs is, that turns at most 20 degrees less far.
    """
    if not len(folded):
        return np.zeros(0, bool)
    ends = _common(faces[folded])
    middles, turn = made[ends].mean(axis=1), _turns(made, faces, folded, ends)
    corners = _welded(*solid)
    is_wedge = _at_edges(middles, turn, corners, REACH * cell)
    left = np.flatnonzero(~is_wedge)
    is_wedge[left] = _at_crossings(middles[left], turn[left], corners, cell)
    return is_wedge


def _common(pairs: Indices) -> Indices:
    """The two vertices (n, 2) that both triangles of a pair (n, 2, 3) have."""
    is_common = (pairs[:, 0, :, None] == pairs[:, 1, None, :]).any(axis=2)
    return pairs[:, 0][is_common].reshape(-1, 2)


def _turns(positions: Floats, triangles: Indices, pairs: Indices, ends: Indices) -> Floats:
    """The angles in degrees between pairs of triangles at edges; negative where concave."""
    normals, _ = measures.facet_normals(positions, triangles)
    n, m = normals[pairs[:, 0]], normals[pairs[:, 1]]
    turn = np.degrees(np.arctan2(np.linalg.norm(np.cross(n, m), axis=1), (n * m).sum(axis=1)))
    beyond = positions[triangles[pairs[:, 1]]].mean(axis=1) - positions[ends[:, 0]]
    return np.where((n * beyond).sum(axis=1) > 0, -turn, turn)


def _welded(positions: Floats, triangles: Indices) -> tuple[Floats, Indices]:
    """Merges equal vertices; drops triangles without area and both faces of sheets."""
    positions, names = np.unique(positions, axis=0, return_inverse=True)
    triangles = names.reshape(-1)[triangles]
    _, first, counts = np.unique(
        np.sort(triangles, axis=1), axis=0, return_index=True, return_counts=True
    )
    triangles = triangles[np.sort(first[counts == 1])]
    _, areas = measures.facet_normals(positions, triangles)
    return positions, triangles[areas > 0]


def _at_edges(
    points: Floats, turn: Floats, mesh: tuple[Floats, Indices], reach: float
) -> np.ndarray:
    """Whether a mesh turns as far within reach of a point, to the same side.

    The turn may be at one edge, or at several in a row, as where an edge is chamfered.
    """
    found = np.zeros(len(points), bool)
    ends, pairs, degrees = measures.edges(*mesh)
    bent = degrees > LEAST_BEND
    if not bent.any():
        return found
    ends, pairs = ends[bent], pairs[bent]
    own = _turns(*mesh, pairs, ends)
    normals, _ = measures.facet_normals(*mesh)
    for first, near in Nearest(mesh[0][ends]).candidates(points, reach):
        fits = near.squared <= reach**2
        fits &= (own[near.items] > 0) == (turn[near.queries + first] > 0)
        queries, items = near.queries[fits], near.items[fits]
        order = np.argsort(queries, kind="stable")
        starts = np.unique(queries[order], return_index=True)[1]
        for group in np.split(order, starts[1:]):
            if len(group):
                query = first + queries[group[0]]
                most = _widest(pairs[items[group]], normals)
                found[query] = most > np.abs(turn[query]) - SLACK
    return found


def _widest(pairs: Indices, normals: Floats) -> float:
    """The largest angle in degrees between faces that pairs (n, 2) of faces connect."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    faces, links = np.unique(pairs, return_inverse=True)
    links = links.reshape(-1, 2)
    graph = coo_matrix((np.ones(len(links)), links.T), shape=(len(faces), len(faces)))
    _, label = connected_components(graph, directed=False)
    own = normals[faces]
    cosines = np.where(label[:, None] == label[None, :], own @ own.T, 1)
    return float(np.degrees(np.arccos(np.clip(cosines.min(), -1, 1))))


def _at_crossings(
    points: Floats, turn: Floats, mesh: tuple[Floats, Indices], cell: float
) -> np.ndarray:
    """Whether a point is near a line along which triangles cross that are as far from parallel.

    There a solid is concave, as where parts overlap. It is convex where only the space behind both
    triangles is inside, as where a cap of a hole leaves its mesh for a bit: winding numbers decide.
    """
    found = np.zeros(len(points), bool)
    if not len(points):
        return found
    corners = mesh[0][mesh[1]]
    normals, _ = measures.facet_normals(*mesh)
    reach = REACH * cell
    for first, near in Nearest(corners).candidates(points, reach):
        for query in np.unique(near.queries):
            items = near.items[(near.queries == query) & (near.squared <= reach**2)]
            a, b = np.triu_indices(len(items), 1)
            a, b = items[a], items[b]
            limit = np.cos(np.radians(abs(turn[first + query]) - SLACK))
            steep = (normals[a] * normals[b]).sum(axis=1) < limit
            a, b = a[steep], b[steep]
            start, end, met = _crossings(corners[a], corners[b])
            squares = to_segments(points[first + query], start, end)
            close = squares <= reach**2
            if turn[first + query] > 0:
                middles = (start[close] + end[close]) / 2
                pairs = normals[np.stack([a, b], axis=1)[met][close]]
                close = _are_convex(middles, pairs, corners, ASIDE * cell)
            found[first + query] = close.any()
    return found


def _are_convex(points: Floats, normals: Floats, corners: Floats, aside: float) -> np.ndarray:
    """Whether of four points around each crossing of planes only the one behind both is inside."""
    n, m = normals[:, 0], normals[:, 1]
    cosine = (n * m).sum(axis=1)
    shares = []
    for s, t in ((-1, -1), (1, -1), (-1, 1), (1, 1)):
        # The direction whose products with both normals are s and t.
        direction = (s - cosine * t)[:, None] * n + (t - cosine * s)[:, None] * m
        direction /= np.linalg.norm(direction, axis=1)[:, None]
        shares.append(_winding_numbers(points + aside * direction, corners))
    return np.array([shares[0] > 0.5, *(share < 0.5 for share in shares[1:])]).all(axis=0)


def _winding_numbers(points: Floats, corners: Floats) -> Floats:
    """Winding numbers of triangles around points (van Oosterom and Strackee 1983)."""
    sums = np.zeros(len(points))
    for i, point in enumerate(points):
        a, b, c = np.moveaxis(corners - point, 1, 0)
        x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=1)
        rest = x * y * z + (a * b).sum(axis=1) * z + (b * c).sum(axis=1) * x
        rest += (c * a).sum(axis=1) * y
        sums[i] = np.arctan2(volume, rest).sum() / (2 * np.pi)
    return sums


def _crossings(a: Floats, b: Floats) -> tuple[Floats, Floats, Indices]:
    """The ends of the segments that pairs of triangles (n, 3, 3) have in common, and which have."""
    n, m = (np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]) for t in (a, b))
    line = np.cross(n, m)
    from_b = np.einsum("nij,nj->ni", a - b[:, :1], m)
    from_a = np.einsum("nij,nj->ni", b - a[:, :1], n)
    kept = np.linalg.norm(line, axis=1) > 0
    for heights in (from_a, from_b):
        kept &= (heights < 0).any(axis=1) & (heights >= 0).any(axis=1)
    a, b, line = a[kept], b[kept], line[kept]
    chords = [_chord(a, from_b[kept], line), _chord(b, from_a[kept], line)]
    (low, start), (high, end) = (
        _extreme([chord[k] for chord in chords], line, is_least=k == 1) for k in range(2)
    )
    met = low < high
    return start[met], end[met], np.flatnonzero(kept)[met]


def _chord(corners: Floats, heights: Floats, line: Floats) -> tuple[Floats, Floats]:
    """The ends, in order along a line, of the triangles' sections with a plane."""
    rows = np.arange(len(corners))
    low = heights < 0
    # The corner that is alone on its side.
    alone = np.where(low.sum(axis=1) == 1, low.argmax(axis=1), (~low).argmax(axis=1))
    ends = []
    for k in (1, 2):
        other = (alone + k) % 3
        h, g = heights[rows, alone], heights[rows, other]
        share = (h / (h - g))[:, None]
        ends.append(corners[rows, alone] + share * (corners[rows, other] - corners[rows, alone]))
    forward = (((ends[1] - ends[0]) * line).sum(axis=1) >= 0)[:, None]
    return np.where(forward, ends[0], ends[1]), np.where(forward, ends[1], ends[0])


def _extreme(points: list[Floats], line: Floats, *, is_least: bool) -> tuple[Floats, Floats]:
    """Returns the least or greatest coordinate along a line per pair of points, and its point."""
    along = np.stack([(p * line).sum(axis=1) for p in points])
    chosen = along.argmin(axis=0) if is_least else along.argmax(axis=0)
    rows = np.arange(len(chosen))
    return along[chosen, rows], np.stack(points)[chosen, rows]
