# SPDX-License-Identifier: GPL-3.0-or-later

"""Solids and sheets of triangles, made with numpy alone, for benchmarks and for tests."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Solid:
    """The arguments of prefilter.voxelize.

    Attributes:
        positions: (vertices, 3).
        triangles: (triangles, 3).
    """

    positions: Floats
    triangles: Indices

    @property
    def corners(self) -> Floats:
        """The corners of each triangle, (triangles, 3, 3)."""
        return self.positions[self.triangles]

    @property
    def volume(self) -> float:
        """The enclosed volume of a closed surface."""
        return mesh_volume(self.positions, self.triangles)

    def transformed(self, matrix: ArrayLike, offset: ArrayLike = (0.0, 0.0, 0.0)) -> "Solid":
        """Turned, scaled and moved; a mirror turns the inside out."""
        return Solid(self.positions @ np.asarray(matrix, float).T + offset, self.triangles)

    def flipped(self) -> "Solid":
        """The solid turned inside out."""
        return Solid(self.positions, self.triangles[:, ::-1])

    def without(self, removed: ArrayLike) -> "Solid":
        """The solid without some triangles."""
        return Solid(self.positions, np.delete(self.triangles, np.asarray(removed), axis=0))

    def fitted(self, low: ArrayLike, high: ArrayLike) -> "Solid":
        """The solid, scaled evenly and moved so that it fits centered into the box."""
        low, high = np.asarray(low, float), np.asarray(high, float)
        own_low, own_high = self.positions.min(axis=0), self.positions.max(axis=0)
        scale = np.min((high - low) / (own_high - own_low))
        middle = (own_low + own_high) / 2
        return Solid((self.positions - middle) * scale + (low + high) / 2, self.triangles)


def join(*solids: Solid) -> Solid:
    """Several meshes as one."""
    starts = np.cumsum([0] + [len(s.positions) for s in solids[:-1]])
    return Solid(
        np.concatenate([s.positions for s in solids]),
        np.concatenate([s.triangles + k for s, k in zip(solids, starts, strict=True)]),
    )


def box(low: Sequence[float] = (0.0, 0.0, 0.0), high: Sequence[float] = (1.0, 1.0, 1.0)) -> Solid:
    """Two triangles a side: those at low x, high x, low y, ... in order."""
    corners = np.array([[(i >> a) & 1 for a in range(3)] for i in range(8)], float)
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Solid(np.asarray(low) + corners * np.subtract(high, low), np.array(triangles))


def torus(major: float, minor: float, around: int, across: int) -> Solid:
    """Around the z axis, closed along both ways."""
    u, v = np.meshgrid(
        np.arange(around) * 2 * np.pi / around,
        np.arange(across) * 2 * np.pi / across,
        indexing="ij",
    )
    ring = major + minor * np.cos(v)
    positions = np.stack([ring * np.cos(u), ring * np.sin(u), minor * np.sin(v)], axis=-1)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    quads = np.stack([a, b, c, d], axis=-1).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Solid(positions.reshape(-1, 3), triangles)


def sphere(
    radius: float = 1.0, rounds: int = 4, center: Sequence[float] = (0.0, 0.0, 0.0)
) -> Solid:
    """An octahedron whose triangles are split into four, again and again."""
    positions = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    points = np.array(positions, float)
    triangles = np.array(
        [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    )
    for _ in range(rounds):
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, which = np.unique(edges, axis=0, return_inverse=True)
        middles = points[unique].sum(axis=1)
        middles /= np.linalg.norm(middles, axis=1, keepdims=True)
        ab, bc, ca = (len(points) + which.reshape(-1, 3)).T
        a, b, c = triangles.T
        points = np.concatenate([points, middles])
        triangles = np.concatenate(
            [np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
    return Solid(points * radius + np.asarray(center), triangles)


def grid(place: Callable[[Floats, Floats], Floats], columns: int, rows: int) -> Solid:
    """The image of the unit square: `place(u, v)` gives points (..., 3)."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1), indexing="ij")
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    a = i * (rows + 1) + j
    quads = np.stack([a, a + rows + 1, a + rows + 2, a + 1], axis=-1).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Solid(place(u, v).reshape(-1, 3), triangles)


def sheet(rows: int, height: Callable[[Floats, Floats], Floats]) -> Solid:
    """Heights over [-1, 1]^2, of so many quads along each side."""

    def place(u: Floats, v: Floats) -> Floats:
        x, y = 2 * u - 1, 2 * v - 1
        return np.stack([x, y, np.broadcast_to(height(x, y), x.shape)], axis=-1)

    return grid(place, rows, rows)


def soup(solid: Solid, *, jitter: float = 0.0, shrunk: float = 0.0, seed: int = 0) -> Solid:
    """Triangles that share no vertices: these are moved at random, and toward the middles."""
    corners = solid.corners
    moved = corners + shrunk * (corners.mean(axis=1, keepdims=True) - corners)
    moved += np.random.default_rng(seed).uniform(-jitter, jitter, corners.shape)
    return Solid(moved.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def shuffled(triangles: Indices, seed: int = 0) -> Indices:
    """Half of the faces inside out, at random."""
    changed = triangles.copy()
    turned = np.random.default_rng(seed).random(len(triangles)) < 0.5
    changed[turned] = changed[turned][:, ::-1]
    return changed


def random_rotation(seed: int) -> Floats:
    """A matrix, (3, 3)."""
    rotation, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return rotation * np.linalg.det(rotation)


def mesh_volume(positions: ArrayLike, triangles: Indices) -> float:
    """The volume that a closed surface holds."""
    a, b, c = np.moveaxis(np.asarray(positions, float)[triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
