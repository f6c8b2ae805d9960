# SPDX-License-Identifier: GPL-3.0-or-later

"""Nearest points of triangles and of segments, independent of the library."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
LEAF = 4
PARTS = 48  # Longer items than that part of the whole are sorted by pieces.
CHUNK = 4096
ROUNDING = 1e-12


@dataclass(frozen=True)
class Pairs:
    """Queries and candidates for their nearest items, with `squared` distances."""

    queries: Indices
    items: Indices
    squared: Floats


class Nearest:
    """A tree of boxes around triangles, (n, 3, 3), or segments, (n, 2, 3)."""

    def __init__(self, corners: Floats) -> None:
        """Sorts the items along a Morton curve; there has to be at least one."""
        from scipy.spatial import cKDTree

        self._corners = np.asarray(corners, np.float64)
        self._measure = to_triangles if self._corners.shape[1] == 3 else to_segments
        parts, owners = _short(self._corners)
        self._middles, self._owners = cKDTree(parts.mean(axis=1)), owners
        count = len(parts)
        leaves = 1
        while leaves * LEAF < count:
            leaves *= 2
        self._leaves = leaves
        order = _morton_order(parts.mean(axis=1))
        # The last item is repeated, so that all leaves are full.
        filled = np.minimum(np.arange(leaves * LEAF), count - 1)
        order = order[filled]
        self._items = owners[order].reshape(leaves, LEAF)
        placed = parts[order].reshape(leaves, -1, 3)
        lows, highs = [placed.min(axis=1)], [placed.max(axis=1)]
        while len(lows[-1]) > 1:
            lows.append(lows[-1].reshape(-1, 2, 3).min(axis=1))
            highs.append(highs[-1].reshape(-1, 2, 3).max(axis=1))
        self._lows, self._highs = lows[::-1], highs[::-1]

    def distances(self, points: Floats) -> Floats:
        """Returns how far each point is from the nearest item."""
        found = np.empty(len(points))
        for first, pairs in self.candidates(points, 0.0):
            best = np.full(min(CHUNK, len(points) - first), np.inf)
            np.minimum.at(best, pairs.queries, pairs.squared)
            found[first : first + len(best)] = np.sqrt(best)
        return found

    def candidates(self, points: Floats, slack: float) -> Iterator[tuple[int, Pairs]]:
        """Yields, for runs of points, the first one's index and the items that count for them.

        Items count that are at most `slack` farther than the nearest one; queries are counted from
        the first of the run.
        """
        points = np.asarray(points, np.float64)
        for first in range(0, len(points), CHUNK):
            some = points[first : first + CHUNK]
            pairs = self._of_leaves(some, *self._near(some, slack))
            best = np.full(len(some), np.inf)
            np.minimum.at(best, pairs.queries, pairs.squared)
            kept = pairs.squared <= (np.sqrt(best[pairs.queries]) + slack) ** 2 * (1 + ROUNDING)
            yield first, Pairs(pairs.queries[kept], pairs.items[kept], pairs.squared[kept])

    def _near(self, points: Floats, slack: float) -> tuple[Indices, Indices]:
        # The item of a nearby part bounds the distance of the nearest item.
        _, parts = self._middles.query(points)
        items = self._owners[parts]
        most = self._measure(points, *np.moveaxis(self._corners[items], 1, 0))
        most = (np.sqrt(most) + slack) ** 2 * (1 + ROUNDING)
        queries, nodes = np.arange(len(points)), np.zeros(len(points), np.int64)
        for lows, highs in zip(self._lows[1:], self._highs[1:], strict=True):
            queries = np.repeat(queries, 2)
            nodes = (2 * nodes[:, None] + np.arange(2)).ravel()
            near = _to_boxes(points[queries], lows[nodes], highs[nodes]) <= most[queries]
            queries, nodes = queries[near], nodes[near]
        return queries, nodes

    def _of_leaves(self, points: Floats, queries: Indices, leaves: Indices) -> Pairs:
        items = self._items[leaves].ravel()
        queries = np.repeat(queries, LEAF)
        corners = self._corners[items]
        return Pairs(queries, items, self._measure(points[queries], *np.moveaxis(corners, 1, 0)))


def to_segments(p: Floats, a: Floats, b: Floats) -> Floats:
    """Returns the squared distance of each point from its segment."""
    along = b - a
    length = np.maximum(_dot(along, along), 1e-300)
    share = np.clip(_dot(p - a, along) / length, 0, 1)
    away = p - a - share[:, None] * along
    return _dot(away, away)


def to_triangles(p: Floats, a: Floats, b: Floats, c: Floats) -> Floats:
    """Returns the squared distance of each point from its triangle."""
    squared = to_segments(p, a, b)
    np.minimum(squared, to_segments(p, b, c), out=squared)
    np.minimum(squared, to_segments(p, c, a), out=squared)
    normal = np.cross(b - a, c - a)
    over = np.ones(len(p), bool)
    for first, second in ((a, b), (b, c), (c, a)):
        over &= _dot(np.cross(second - first, p - first), normal) >= 0
    length = _dot(normal, normal)
    over &= length > 0
    height = _dot(p - a, normal) ** 2 / np.maximum(length, 1e-300)
    return np.where(over, np.minimum(height, squared), squared)


def _dot(a: Floats, b: Floats) -> Floats:
    return np.einsum("...i,...i->...", a, b)


def _to_boxes(points: Floats, lows: Floats, highs: Floats) -> Floats:
    away = np.maximum(np.maximum(lows - points, points - highs), 0)
    return _dot(away, away)


def _short(corners: Floats) -> tuple[Floats, Indices]:
    """Halves long items at their longest side; returns the parts, and the item of each."""
    owners = np.arange(len(corners))
    limit = np.ptp(corners.reshape(-1, 3), axis=0).max() / PARTS
    done, done_owners = [], []
    while len(corners):
        sides = np.roll(corners, -1, axis=1) - corners
        squared = _dot(sides, sides)
        long = squared.max(axis=1) > limit**2
        done.append(corners[~long])
        done_owners.append(owners[~long])
        corners, owners = corners[long], owners[long]
        rows = np.arange(len(corners))
        start = squared[long].argmax(axis=1)
        end = (start + 1) % corners.shape[1]
        middle = (corners[rows, start] + corners[rows, end]) / 2
        halves = [corners.copy(), corners.copy()]
        halves[0][rows, start] = middle
        halves[1][rows, end] = middle
        corners, owners = np.concatenate(halves), np.tile(owners, 2)
    return np.concatenate(done), np.concatenate(done_owners)


def _morton_order(points: Floats) -> Indices:
    low, extent = points.min(axis=0), np.ptp(points, axis=0).max()
    cells = ((points - low) * ((2**20 - 1) / max(extent, 1e-300))).astype(np.uint64)
    code = np.zeros(len(points), np.uint64)
    for axis in range(3):
        bits = cells[:, axis]
        for shift, mask in (
            (32, 0x1F00000000FFFF),
            (16, 0x1F0000FF0000FF),
            (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3),
            (2, 0x1249249249249249),
        ):
            bits = (bits | (bits << np.uint64(shift))) & np.uint64(mask)
        code |= bits << np.uint64(axis)
    return np.argsort(code, kind="stable")
