# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures of surfaces against the shapes that they were made from.

Lengths are in cells, angles in degrees. Nothing here calls the library.
"""

import os
import subprocess
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .nearest import Nearest

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
SPACING = 0.25  # Between samples of an edge.
SAMPLES = 60_000  # Per surface.
SLACK = 0.01  # Faces that are that much farther than the nearest one are adjacent to the edge.
WRONG_DEGREES = 10.0
FOLD = 120.0  # Degrees.
CHECKER = Path(__file__).resolve().parents[2] / "build/bench/self_intersections"


@dataclass(frozen=True)
class Edges:
    """Edges of a mesh: ends (n, 2, 3), and the angles by which its faces turn there."""

    ends: Floats
    degrees: Floats


@dataclass(frozen=True)
class EdgeErrors:
    """Distances of samples of the true edges from the surface, and from its sharp edges.

    An edge of the result is sharp if it turns by more than half of the true edge's turn. Corners
    are ends of true edges; `corner` is their largest distance from a vertex of the result.
    """

    surface_mean: float
    surface_95: float
    crease_mean: float
    crease_95: float
    crease_most: float
    corner: float

    @property
    def numbers(self) -> list[float]:
        """All of them, in order."""
        return list(vars(self).values())


@dataclass(frozen=True)
class SurfaceErrors:
    """Shares of the area, and, farther than two cells from edges, vertex and normal errors.

    `wrong` is the share of the area more than 10 degrees off the true surface where it is nearest;
    where that is at an edge, off the better one of its faces.
    """

    wrong: float
    normal_mean: float
    vertex_rms: float
    vertex_most: float


@dataclass(frozen=True)
class Soundness:
    """Defects of a mesh as a closed two-manifold surface without self-intersections.

    `intersections` counts pairs of triangles; it is -1 where the program that counts is missing.
    """

    open_edges: int
    crowded_edges: int
    crowded_vertices: int
    flat_triangles: int
    intersections: int
    example: tuple[int, int]

    @property
    def is_manifold(self) -> bool:
        """Whether it is closed and two-manifold."""
        return not (self.open_edges or self.crowded_edges or self.crowded_vertices)

    @property
    def is_sound(self) -> bool:
        """Whether nothing was found."""
        return self.is_manifold and self.intersections <= 0


def facet_normals(positions: Floats, triangles: Indices) -> tuple[Floats, Floats]:
    """Returns unit normals, and areas."""
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1)
    return normals / np.maximum(length, 1e-300)[:, None], length / 2


def edges(positions: Floats, triangles: Indices) -> tuple[Indices, Indices, Floats]:
    """Returns the vertices (n, 2) and faces (n, 2) of edges that two faces share, and angles."""
    normals, _ = facet_normals(positions, triangles)
    ends = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]).astype(np.int64)
    faces = np.tile(np.arange(len(triangles)), 3)
    key = ends.min(axis=1) * len(positions) + ends.max(axis=1)
    order = np.argsort(key, kind="stable")
    key = key[order]
    starts = np.flatnonzero(np.r_[True, key[1:] != key[:-1]])
    twice = starts[np.diff(np.r_[starts, len(key)]) == 2]
    pairs = faces[np.stack([order[twice], order[twice + 1]], axis=1)]
    n, m = normals[pairs[:, 0]], normals[pairs[:, 1]]
    turn = np.arctan2(np.linalg.norm(np.cross(n, m), axis=1), (n * m).sum(axis=1))
    return ends[order[twice]], pairs, np.degrees(turn)


def sharp_edges(positions: Floats, triangles: Indices, degrees: float) -> Edges:
    """The edges that turn by more than so many degrees."""
    ends, _, turn = edges(positions, triangles)
    sharp = turn > degrees
    return Edges(positions[ends[sharp]], turn[sharp])


def folds(
    positions: Floats,
    triangles: Indices,
    degrees: float = FOLD,
    true_edges: Edges | None = None,
    reach: float = 0.0,
) -> int:
    """Counts the edges of `folded_pairs`."""
    return len(folded_pairs(positions, triangles, degrees, true_edges, reach))


def folded_pairs(
    positions: Floats,
    triangles: Indices,
    degrees: float = FOLD,
    true_edges: Edges | None = None,
    reach: float = 0.0,
) -> Indices:
    """The pairs of triangles (n, 2) at edges that turn by more than so many degrees.

    Given `true_edges`, pairs within `reach` of an edge of the shape that turns by at least that
    angle less 20 degrees are left out: a wedge is no fold.
    """
    ends, pairs, turn = edges(positions, triangles)
    folded = turn > degrees
    if true_edges is None or not folded.any():
        return pairs[folded]
    wedges = true_edges.ends[true_edges.degrees > degrees - 20]
    if not len(wedges):
        return pairs[folded]
    middles = positions[ends[folded]].mean(axis=1)
    return pairs[folded][Nearest(wedges).distances(middles) > reach]


def topology(triangles: Indices) -> tuple[int, int]:
    """Returns the number of parts of a closed surface, and the genus of all of them together."""
    triangles = np.asarray(triangles, np.int64)
    if len(triangles) == 0:
        return 0, 0
    label = np.arange(int(triangles.max()) + 1)
    while True:
        least = label[triangles].min(axis=1)
        before = label.copy()
        for k in range(3):
            np.minimum.at(label, triangles[:, k], least)
        label = label[label]
        if np.array_equal(before, label):
            break
    used = np.unique(triangles)
    parts = len(np.unique(label[used]))
    euler = len(used) - 3 * len(triangles) // 2 + len(triangles)
    return parts, (2 * parts - euler) // 2


def corner_points(lines: Edges) -> Floats:
    """Ends of edges where one, or more than two, or two that turn by over 30 degrees come."""
    points = lines.ends.reshape(-1, 3)
    away = (lines.ends[:, ::-1] - lines.ends).reshape(-1, 3)
    away /= np.maximum(np.linalg.norm(away, axis=1), 1e-300)[:, None]
    unique, which, counts = np.unique(
        points.round(12), axis=0, return_inverse=True, return_counts=True
    )
    total = np.zeros((len(unique), 3))
    np.add.at(total, which.ravel(), away)
    straight = np.linalg.norm(total, axis=1) < 2 * np.sin(np.radians(15))
    return unique[(counts != 2) | ~straight]


def edge_errors(positions: Floats, triangles: Indices, truth: Edges, cell: float) -> EdgeErrors:
    """Compares a surface with the true edges."""
    ends, _, turn = edges(positions, triangles)
    length = np.linalg.norm(truth.ends[:, 1] - truth.ends[:, 0], axis=1)
    counts = np.ceil(length / (SPACING * cell)).astype(int)
    owner = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (number + 0.5) / counts[owner]
    start, end = truth.ends[owner, 0], truth.ends[owner, 1]
    points = start + share[:, None] * (end - start)
    weights = (length / np.maximum(counts, 1))[owner]
    surface = Nearest(positions[triangles]).distances(points) / cell
    crease = np.empty(len(points))
    # Angles by steps of 5 degrees, so that few trees are made.
    steps = np.floor(truth.degrees[owner] / 5)
    for step in np.unique(steps):
        chosen = steps == step
        sharp = turn > 2.5 * step
        if not sharp.any():
            crease[chosen] = np.inf
            continue
        crease[chosen] = Nearest(positions[ends[sharp]]).distances(points[chosen]) / cell
    corners = corner_points(truth)
    corner = 0.0
    if len(corners):
        used = positions[np.unique(triangles)]
        corner = Nearest(np.stack([used, used], axis=1)).distances(corners).max() / cell
    return EdgeErrors(
        float(np.average(surface, weights=weights)),
        weighted_quantile(surface, weights, 0.95),
        float(np.average(crease, weights=weights)),
        weighted_quantile(crease, weights, 0.95),
        float(crease.max()),
        float(corner),
    )


def weighted_quantile(values: Floats, weights: Floats, share: float) -> float:
    """Returns the quantile of values with weights: the value at that share of their sum."""
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(below, share * below[-1])])


def surface_samples(positions: Floats, triangles: Indices, count: int) -> tuple[Floats, Indices]:
    """Points spread evenly over the area, and their triangles."""
    _, areas = facet_normals(positions, triangles)
    below = np.cumsum(areas)
    places = (np.arange(count) + 0.5) / count * below[-1]
    faces = np.searchsorted(below, places)
    u, v = np.random.default_rng(0).random((2, count))
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    a, b, c = np.moveaxis(positions[triangles[faces]], 1, 0)
    return a + u[:, None] * (b - a) + v[:, None] * (c - a), faces


def surface_errors(
    positions: Floats,
    triangles: Indices,
    true_positions: Floats,
    true_triangles: Indices,
    true_edges: Edges,
    cell: float,
    samples: int = SAMPLES,
) -> SurfaceErrors:
    """Compares normals and vertices of a surface with the true one."""
    points, off = _samples_off(positions, triangles, true_positions, true_triangles, cell, samples)
    _, true_areas = facet_normals(true_positions, true_triangles)
    tree = Nearest(true_positions[true_triangles[true_areas > 0]])
    used = positions[np.unique(triangles)]
    if len(used) > samples:
        used = used[:: -(-len(used) // samples)]
    if len(true_edges.ends):
        edge_tree = Nearest(true_edges.ends)
        smooth = edge_tree.distances(points) > 2 * cell
        used = used[edge_tree.distances(used) > 2 * cell]
    else:
        smooth = np.ones(len(points), bool)
    vertices = tree.distances(used) / cell if len(used) else np.zeros(1)
    return SurfaceErrors(
        float((off > WRONG_DEGREES).mean()),
        float(off[smooth].mean()) if smooth.any() else 0.0,
        float(np.sqrt((vertices**2).mean())),
        float(vertices.max()),
    )


def degrees_off(
    positions: Floats,
    triangles: Indices,
    true_positions: Floats,
    true_triangles: Indices,
    cell: float,
    samples: int = SAMPLES,
) -> Floats:
    """Angles at samples of a surface between its normal and the nearest true one."""
    return _samples_off(positions, triangles, true_positions, true_triangles, cell, samples)[1]


def _samples_off(
    positions: Floats,
    triangles: Indices,
    true_positions: Floats,
    true_triangles: Indices,
    cell: float,
    samples: int,
) -> tuple[Floats, Floats]:
    points, faces = surface_samples(positions, triangles, samples)
    normals, _ = facet_normals(positions, triangles)
    true_normals, true_areas = facet_normals(true_positions, true_triangles)
    sound = true_areas > 0
    tree = Nearest(true_positions[true_triangles[sound]])
    true_normals = true_normals[sound]
    best = np.full(len(points), -1.0)
    for first, pairs in tree.candidates(points, SLACK * cell):
        queries = pairs.queries + first
        cosines = (normals[faces[queries]] * true_normals[pairs.items]).sum(axis=1)
        np.maximum.at(best, queries, cosines)
    return points, np.degrees(np.arccos(np.clip(best, -1, 1)))


def smallest_angles(positions: Floats, triangles: Indices) -> Floats:
    """Returns the smallest angle of each triangle."""
    corners = positions[triangles]
    found = np.full(len(triangles), 180.0)
    for k in range(3):
        u = corners[:, (k + 1) % 3] - corners[:, k]
        v = corners[:, (k + 2) % 3] - corners[:, k]
        sine = np.linalg.norm(np.cross(u, v), axis=1)
        found = np.minimum(found, np.degrees(np.arctan2(sine, (u * v).sum(axis=1))))
    return found


def soundness(positions: Floats, triangles: Indices) -> Soundness:
    """Looks at every edge, every fan, and every pair of triangles."""
    found = manifoldness(triangles, len(positions))
    pairs, _, flat, example = self_intersections(positions, triangles)
    return replace(found, flat_triangles=flat, intersections=pairs, example=example)


def manifoldness(triangles: Indices, vertices: int) -> Soundness:
    """Looks at every edge and every fan; leaves positions alone."""
    triangles = np.asarray(triangles, np.int64)
    directed = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    key = directed.min(axis=1) * max(vertices, 1) + directed.max(axis=1)
    unique, which = np.unique(key, return_inverse=True)
    which = which.ravel()
    forward = np.bincount(which, directed[:, 0] < directed[:, 1], len(unique))
    total = np.bincount(which, minlength=len(unique))
    return Soundness(
        int((total == 1).sum()),
        int(((total > 2) | ((total == 2) & (forward != 1))).sum()),
        _crowded_vertices(triangles, which),
        -1,
        -1,
        (-1, -1),
    )


def _crowded_vertices(triangles: Indices, edge_of: Indices) -> int:
    """Counts vertices whose triangles are more than one fan, by labels that spread along edges."""
    count = len(triangles)
    corner = np.arange(3 * count).reshape(count, 3)
    vertex = triangles.ravel()
    # Sides in the order of `edge_of`: of all triangles the first, then the second, then the third.
    side_corner = np.concatenate([corner[:, [k, (k + 1) % 3]] for k in range(3)])
    order = np.argsort(edge_of, kind="stable")
    same = edge_of[order[1:]] == edge_of[order[:-1]]
    first, second = side_corner[order[:-1][same]], side_corner[order[1:][same]]
    crossed = vertex[first[:, 0]] != vertex[second[:, 0]]
    second = np.where(crossed[:, None], second[:, ::-1], second)
    links = np.concatenate([np.stack([first[:, k], second[:, k]], axis=1) for k in range(2)])
    label = np.arange(3 * count)
    while True:
        low = np.minimum(label[links[:, 0]], label[links[:, 1]])
        before = label.copy()
        np.minimum.at(label, links[:, 0], low)
        np.minimum.at(label, links[:, 1], low)
        label = label[label]
        if np.array_equal(before, label):
            break
    fans = np.unique(np.stack([vertex, label], axis=1), axis=0)
    return int((np.unique(fans[:, 0], return_counts=True)[1] > 1).sum())


def checker() -> str:
    """The program that counts self-intersections; empty where it was not built."""
    named = os.environ.get("PREFILTER_SELF_INTERSECTIONS", "")
    return named or (str(CHECKER) if CHECKER.exists() else "")


def self_intersections(
    positions: Floats, triangles: Indices
) -> tuple[int, int, int, tuple[int, int]]:
    """Returns the pairs of triangles that cut each other, triangles in them, flat triangles.

    And the triangles of one pair. All are -1 where the program that counts is missing.
    """
    program = checker()
    if not program:
        return -1, -1, -1, (-1, -1)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh"
        with path.open("wb") as file:
            np.array([len(positions), len(triangles)], np.int64).tofile(file)
            np.ascontiguousarray(positions, np.float64).tofile(file)
            np.ascontiguousarray(triangles, np.int64).tofile(file)
        made = subprocess.run([program, str(path)], capture_output=True, text=True, check=True)
    pairs, faces, flat, a, b = map(int, made.stdout.split())
    return pairs, faces, flat, (a, b)
