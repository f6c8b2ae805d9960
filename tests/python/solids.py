# SPDX-License-Identifier: GPL-3.0-or-later

"""Solids for tests of voxels: meshes, and their properties by independent methods.

Nothing here calls the library or shares a method with it: occupancies are exact integrals of
heights over columns of cells, and generalized winding numbers decide which points are inside.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.solids import (
    Solid,
    box,
    grid,
    join,
    mesh_volume,
    random_rotation,
    sheet,
    shuffled,
    soup,
    sphere,
    torus,
)
from bench.voxels import meshes

__all__ = [
    "Solid",
    "box",
    "grid",
    "join",
    "mesh_volume",
    "random_rotation",
    "sheet",
    "shuffled",
    "soup",
    "sphere",
    "torus",
]

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "meshes"


def load(name: str) -> Solid:
    """One of the models gathered beside the checkout; skips the test where it is absent."""
    path = DATA / name
    if not path.exists():
        pytest.skip(f"the model {name} is not there")
    read = meshes.read(path)
    return Solid(read.positions, read.triangles)


def crumpled(seed: int, rounds: int = 2, strength: float = 0.35) -> Solid:
    """A closed surface without a symmetry, with a winding number of 1 inside and slanted slivers.

    Each vertex of a sphere is moved along its ray.
    """
    random = np.random.default_rng(seed)
    made = sphere(1.0, rounds)
    moved = made.positions * (1 + strength * random.uniform(-1, 1, (len(made.positions), 1)))
    turned = Solid(moved, made.triangles).transformed(random_rotation(seed))
    return turned.transformed(0.31 * np.eye(3), random.uniform(0.45, 0.55, 3))


def pieces(corners: np.ndarray, low, high, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles, (m, 3, 3), cut along the planes of n^3 cells of a box.

    Returns the pieces in units of cells, as triangles, and the cell (3 integers) of each; cells
    outside of the box get the nearest numbers below 0 or beyond n - 1.
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    made = (np.asarray(corners, float) - low) * (n / (high - low))
    for axis in range(3):
        for plane in range(n + 1):
            made = _split(made, axis, float(plane))
    middles = made.mean(axis=1)
    return made, np.clip(np.floor(middles), -1, n).astype(int)


def _split(triangles: np.ndarray, axis: int, plane: float) -> np.ndarray:
    """Cuts the triangles that a plane passes through, each into three."""
    heights = triangles[:, :, axis] - plane
    cut = (heights.min(axis=1) < 0) & (heights.max(axis=1) > 0)
    if not cut.any():
        return triangles
    parts, heights = triangles[cut], heights[cut]
    above = heights > 0
    alone_above = above.sum(axis=1) == 1
    # The corner that is by itself on its side comes first.
    first = np.argmax(above == alone_above[:, None], axis=1)
    order = (first[:, None] + np.arange(3)) % 3
    rows = np.arange(len(parts))[:, None]
    (a, b, c), (ha, hb, hc) = np.moveaxis(parts[rows, order], 1, 0), heights[rows, order].T
    p = a + (b - a) * (ha / (ha - hb))[:, None]
    q = a + (c - a) * (ha / (ha - hc))[:, None]
    p[:, axis] = q[:, axis] = plane
    made = [np.stack(t, axis=1) for t in ((a, p, q), (p, b, c), (p, c, q))]
    return np.concatenate([triangles[~cut], *made])


def occupancies(solid: Solid, low, high, n: int) -> np.ndarray:
    """The mean winding number over each of the n^3 cells [x, y, z], exactly.

    It integrates the heights of the surface over each column of cells: a piece that faces up adds
    the volume below it, and a piece that faces down subtracts it.
    """
    parts, cells = pieces(solid.corners, low, high, n)
    a, b, c = np.moveaxis(parts, 1, 0)
    up = 0.5 * np.cross(b - a, c - a)[:, 2]
    height = parts[:, :, 2].mean(axis=1)
    found = np.zeros((n, n, n + 1))  # The last one is for all that is above the box.
    inside = ((cells[:, :2] >= 0) & (cells[:, :2] < n)).all(axis=1) & (cells[:, 2] >= 0)
    x, y, z = cells[inside].T
    np.add.at(found, (x, y, z), np.where(z < n, up[inside] * (height[inside] - z), 0.0))
    whole = np.zeros_like(found)
    np.add.at(whole, (x, y, z), up[inside])
    below = np.cumsum(whole[..., ::-1], axis=2)[..., ::-1]
    return (found[..., :n]) + below[..., 1:]


def winding_numbers(solid: Solid, points: np.ndarray) -> np.ndarray:
    """Generalized winding numbers (Jacobson et al. 2013), by the solid angle of every triangle."""
    found, step = np.zeros(len(points)), max(1, 200_000 // max(1, len(solid.triangles)))
    for start in range(0, len(points), step):
        some = points[start : start + step]
        found[start : start + step] = _solid_angles(solid.corners, some) / (4 * np.pi)
    return found


def _solid_angles(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The sum of the solid angles of triangles at each point, after Van Oosterom and Strackee.

    Products of differences to a point are polynomials of it: sums over the triangles are products
    of matrices. The origin is moved to the points, which keeps what cancels small.
    """
    middle = points.mean(axis=0)
    p = points - middle
    a, b, c = np.moveaxis(corners - middle, 1, 0)
    ones = np.ones((len(p), 1))
    squares = _rowdot(p, p)[:, None]

    def product(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.hstack([ones, squares, p]) @ np.vstack(
            [_rowdot(u, v), np.ones(len(u)), -(u + v).T]
        )

    la, lb, lc = (np.sqrt(np.maximum(product(v, v), 0.0)) for v in (a, b, c))
    area = np.cross(a, b) + np.cross(b, c) + np.cross(c, a)
    volume = np.hstack([ones, p]) @ np.vstack([_rowdot(a, np.cross(b, c)), -area.T])
    below = la * lb * lc + product(a, b) * lc + product(b, c) * la + product(c, a) * lb
    return 2 * np.arctan2(volume, below).sum(axis=1)


def _rowdot(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", u, v)


class WindingNumbers:
    """Winding numbers of many points, faster.

    A fan over its boundary closes an open surface. The winding number of a closed surface counts
    its signed crossings with a ray up from the point; the fan's share is then subtracted again.
    """

    COLUMNS = 128  # Along x and along y.

    def __init__(self, solid: Solid) -> None:
        self._fan = open_fan(solid)
        corners = np.concatenate([solid.corners, self._fan.corners])
        self._low = corners.min(axis=(0, 1))[:2]
        self._scale = self.COLUMNS / (np.ptp(corners[..., :2], axis=(0, 1)) + 1e-30)
        first, last = (self._columns(ends(corners, axis=1)[:, :2]).T for ends in (np.min, np.max))
        across = last - first + 1
        count = across.prod(axis=0)
        which = np.repeat(np.arange(len(corners)), count)
        place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        x = first[0][which] + place // across[1][which]
        y = first[1][which] + place % across[1][which]
        column = x * self.COLUMNS + y
        order = np.argsort(column, kind="stable")
        self._corners, self._which = corners, which[order]
        self._starts = np.searchsorted(column[order], np.arange(self.COLUMNS**2 + 1))

    def __call__(self, points: np.ndarray) -> np.ndarray:
        parts = [self._crossings(points[k : k + 20_000]) for k in range(0, len(points), 20_000)]
        found = np.concatenate([np.zeros(0), *parts])
        if len(self._fan.triangles) > 0:
            found -= winding_numbers(self._fan, points)
        return found

    def _columns(self, places: np.ndarray) -> np.ndarray:
        columns = np.floor((places - self._low) * self._scale).astype(int)
        return np.clip(columns, 0, self.COLUMNS - 1)

    def _crossings(self, points: np.ndarray) -> np.ndarray:
        column = self._columns(points[:, :2]) @ (self.COLUMNS, 1)
        count = self._starts[column + 1] - self._starts[column]
        point = np.repeat(np.arange(len(points)), count)
        place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        triangle = self._which[np.repeat(self._starts[column], count) + place]
        a, b, c = (self._corners[triangle, k] - points[point] for k in range(3))
        # Twice the areas, seen from above, that the point makes with the edges.
        u, v, w = (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((b, c), (c, a), (a, b)))
        area = u + v + w
        is_met = ((u > 0) == (v > 0)) & ((v > 0) == (w > 0)) & (area != 0)
        height = u * a[:, 2] + v * b[:, 2] + w * c[:, 2]
        is_above = is_met & (height * np.sign(area) > 0)
        return np.bincount(point[is_above], np.sign(area)[is_above], minlength=len(points))


def open_fan(solid: Solid) -> Solid:
    """Triangles that close a surface: edges without a twin, each joined to the same point."""
    start, end = solid.triangles.ravel(), np.roll(solid.triangles, -1, axis=1).ravel()
    edges = np.stack([np.minimum(start, end), np.maximum(start, end)], axis=1)
    unique, which = np.unique(edges, axis=0, return_inverse=True)
    excess = np.bincount(which.ravel(), np.where(start < end, 1, -1)).astype(int)
    backward = np.where((excess > 0)[:, None], unique[:, ::-1], unique)
    rim = np.repeat(backward, np.abs(excess), axis=0)
    middle = solid.positions[rim.ravel()].mean(axis=0) if len(rim) else np.zeros(3)
    triangles = np.column_stack([rim, np.full(len(rim), len(solid.positions))])
    return Solid(np.concatenate([solid.positions, middle[None]]), triangles)


@dataclass(frozen=True)
class Estimate:
    """A volume by random points, and its standard error."""

    volume: float
    error: float


class RandomPoints:
    """Volumes by random points and winding numbers, of combinations of solids within a box.

    Each stratum has its own points: two for each of the n^3 cells that may hold some of a surface,
    one for the largest cells that cannot. So an estimate has no bias, and its error comes from the
    cells at the surfaces.
    """

    def __init__(self, solids: list[Solid], low, high) -> None:
        self._low, self._high = np.asarray(low, float), np.asarray(high, float)
        self._solids = solids
        self._numbers = [WindingNumbers(solid) for solid in solids]
        self._random = np.random.default_rng(1)

    def estimate(self, inside, *, error: float = 0.001) -> Estimate:
        """The volume where `inside` accepts the winding numbers, to a relative error."""
        return self.estimates([inside], error=error)[0]

    def estimates(self, insides, *, error: float = 0.001) -> list[Estimate]:
        """Several such volumes, from the same random points."""
        for n in (32, 64, 128, 256):
            found = self._estimates(insides, n)
            if all(each.error < error * each.volume for each in found):
                break
        return found

    def _estimates(self, insides, n: int) -> list[Estimate]:
        meets = np.zeros((n, n, n), bool)
        for solid in self._solids:
            meets |= touched_cells(solid.corners, self._low, self._high, n)
        levels = [meets]
        while len(levels[0]) > 4:
            m = len(levels[0]) // 2
            levels.insert(0, levels[0].reshape(m, 2, m, 2, m, 2).any(axis=(1, 3, 5)))
        volumes, around = np.zeros(len(insides)), np.ones((2, 2, 2), bool)
        for level in levels:
            share = np.prod(self._high - self._low) / level.size
            within = np.kron(around, np.ones((2, 2, 2), bool))
            volumes += share * self._sample(insides, within & ~level).sum(axis=1)
            around = level
        first, second = (self._sample(insides, meets) for _ in range(2))
        volumes += share * (first + second).sum(axis=1) / 2
        errors = share * np.sqrt(((first - second) ** 2).sum(axis=1)) / 2
        return [Estimate(*each) for each in zip(volumes.tolist(), errors.tolist(), strict=True)]

    def _sample(self, insides, chosen: np.ndarray) -> np.ndarray:
        """Whether a random point in each chosen cell is inside, for each of `insides`."""
        cells = np.argwhere(chosen)
        places = (cells + self._random.random(cells.shape)) / len(chosen)
        points = self._low + places * (self._high - self._low)
        numbers = [number(points) for number in self._numbers]
        return np.array([inside(*numbers) for inside in insides], float)


def touched_cells(corners: np.ndarray, low, high, n: int) -> np.ndarray:
    """The n^3 cells that the triangles' bounding boxes overlap: a superset of the cells touched."""
    scaled = (corners - low) * (n / (high - low))
    first, last = (np.floor(f).astype(int) for f in (scaled.min(axis=1), scaled.max(axis=1)))
    within = ((last >= 0) & (first < n)).all(axis=1)
    first, last = np.maximum(first[within], 0), last[within]
    found = np.zeros((n, n, n), bool)
    small = ((last - first) <= 1).all(axis=1) & (last < n).all(axis=1)
    for corner in np.ndindex(2, 2, 2):
        found[tuple(np.where(corner, last[small], first[small]).T)] = True
    for (x, y, z), (p, q, r) in zip(first[~small], last[~small], strict=True):
        found[x : p + 1, y : q + 1, z : r + 1] = True
    return found


@dataclass(frozen=True)
class SurfaceFaults:
    """Defects that keep a surface from being a closed, oriented 2-manifold."""

    open_or_crowded_edges: int
    pinched_vertices: int
    degenerate_triangles: int

    @property
    def none(self) -> bool:
        return self == SurfaceFaults(0, 0, 0)


def surface_faults(positions: np.ndarray, triangles: np.ndarray) -> SurfaceFaults:
    """Each directed edge must have exactly one twin, and each vertex one fan of triangles."""
    triangles = np.asarray(triangles, np.int64)
    repeated = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    a, b, c = np.moveaxis(np.asarray(positions, float)[triangles], 1, 0)
    flat = np.linalg.norm(np.cross(b - a, c - a), axis=1) == 0
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = len(positions)
    forward, backward = start * count + end, end * count + start
    order = np.argsort(forward, kind="stable")
    ranked = forward[order]
    crowded = int((ranked[1:] == ranked[:-1]).sum())
    place = np.searchsorted(ranked, backward)
    found = (place < len(ranked)) & (ranked[np.minimum(place, len(ranked) - 1)] == backward)
    bad = crowded + int((~found).sum())
    pinched = 0
    if bad == 0:
        # Corner i, at the start of edge i, is followed around its vertex by the corner that the
        # twin of the edge before it starts from. Fans are the cycles of that permutation.
        corner = np.arange(len(start))
        before = corner - corner % 3 + (corner + 2) % 3
        step = order[place][before]
        label = corner.copy()
        while True:
            # The least label of 2^k corners in turn. If no label changes, all such runs of a fan
            # have the same one, and together the runs cover the fan.
            least = np.minimum(label, label[step])
            if (least == label).all():
                break
            label, step = least, step[step]
        pinched = len(np.unique(label)) - len(np.unique(start))
    return SurfaceFaults(bad, pinched, int((repeated | flat).sum()))
