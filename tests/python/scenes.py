# SPDX-License-Identifier: GPL-3.0-or-later

"""Small surfaces and images for tests, and lookups written without the library."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import prefilter


@dataclass
class Mesh:
    """The arguments of prefilter.Surface."""

    positions: np.ndarray
    triangles: np.ndarray
    uvs: np.ndarray

    @property
    def surface(self) -> prefilter.Surface:
        return prefilter.Surface(self.positions, self.triangles, self.uvs)

    @property
    def areas(self) -> np.ndarray:
        p = self.positions[self.triangles]
        return 0.5 * np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)


def soup(uvs: np.ndarray, areas: np.ndarray | None = None) -> Mesh:
    """Separate triangles with the given UVs, (n, 3, 2), and areas in space."""
    uvs = np.asarray(uvs, np.float64)
    areas = np.ones(len(uvs)) if areas is None else np.asarray(areas, np.float64)
    side = np.sqrt(2.0 * areas)
    positions = np.zeros((len(uvs), 3, 3))
    positions[:, 1, 0] = side
    positions[:, 2, 1] = side
    triangles = np.arange(3 * len(uvs)).reshape(-1, 3)
    return Mesh(positions.reshape(-1, 3), triangles, uvs)


def square(low=(0.0, 0.0), high=(1.0, 1.0), area: float = 1.0) -> Mesh:
    """Two triangles over a rectangle of the texture."""
    (u0, v0), (u1, v1) = low, high
    uvs = [[(u0, v0), (u1, v0), (u1, v1)], [(u0, v0), (u1, v1), (u0, v1)]]
    return soup(np.array(uvs), np.array([area / 2, area / 2]))


def join(*meshes: Mesh) -> Mesh:
    offsets = np.cumsum([0] + [len(m.positions) for m in meshes[:-1]])
    return Mesh(
        np.concatenate([m.positions for m in meshes]),
        np.concatenate([m.triangles + k for m, k in zip(meshes, offsets, strict=True)]),
        np.concatenate([m.uvs for m in meshes]),
    )


def random_soup(seed: int, count: int, low: float = 0.0, high: float = 1.0) -> Mesh:
    """Overlapping triangles of either winding and very different densities."""
    random = np.random.default_rng(seed)
    uvs = random.uniform(low, high, (count, 3, 2))
    return soup(uvs, random.uniform(0.01, 1.0, count) ** 3)


def random_image(seed: int, height: int, width: int, channels: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0, 1, (height, width, channels)).astype(np.float32)


def surface_samples(mesh: Mesh, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """UVs, (n, 2), and area weights, (n,), of steps^2 points a triangle, spread evenly over it."""
    i, j = np.meshgrid(np.arange(steps), np.arange(steps), indexing="ij")
    upright = i + j < steps
    inverted = i + j < steps - 1
    s = np.concatenate([(i[upright] + 1 / 3), (i[inverted] + 2 / 3)]) / steps
    t = np.concatenate([(j[upright] + 1 / 3), (j[inverted] + 2 / 3)]) / steps
    a, b, c = mesh.uvs[:, 0, None], mesh.uvs[:, 1, None], mesh.uvs[:, 2, None]
    s, t = s[None, :, None], t[None, :, None]
    uvs = a + s * (b - a) + t * (c - a)
    weights = np.repeat(mesh.areas / steps**2, steps**2)
    return uvs.reshape(-1, 2), weights


def samples_inside(mesh: Mesh, steps: int, wrap: tuple[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """Samples of the part with a weight: triangles are clipped at the edges of a border.

    The parts of a triangle get points as dense as the triangle would.
    """
    if "border" not in wrap:
        return surface_samples(mesh, steps)
    found = []
    for uvs, area in zip(mesh.uvs, mesh.areas, strict=True):
        whole = _area(uvs)
        polygon = list(uvs)
        for axis, mode in enumerate(wrap):
            for edge, sign in ((0.0, 1.0), (1.0, -1.0)) if mode == "border" else ():
                polygon = _cut(polygon, axis, edge, sign)
        for second, third in pairwise(polygon[1:]):
            part = np.array([polygon[0], second, third])
            share = _area(part) / whole
            dense = max(1, int(np.ceil(steps * np.sqrt(share))))
            found.append(surface_samples(soup(part[None], [area * share]), dense))
    return np.concatenate([uvs for uvs, _ in found]), np.concatenate([w for _, w in found])


def _area(uvs: np.ndarray) -> float:
    (u, v), (s, t) = uvs[1] - uvs[0], uvs[2] - uvs[0]
    return abs(u * t - v * s) / 2


def _cut(polygon: list[np.ndarray], axis: int, edge: float, sign: float) -> list[np.ndarray]:
    """The part of a convex polygon where sign * (coordinate - edge) is not negative."""
    kept = []
    for start, end in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        a, b = sign * (start[axis] - edge), sign * (end[axis] - edge)
        if a >= 0:
            kept.append(start)
        if a * b < 0:
            kept.append(start + a / (a - b) * (end - start))
    return kept


def wrap_indices(index: np.ndarray, size: int, mode: str) -> tuple[np.ndarray, np.ndarray]:
    """The texel that each index reads, and whether there is one (not outside of a border)."""
    if mode == "repeat":
        return index % size, np.ones(index.shape, bool)
    inside = (index >= 0) & (index < size)
    return np.clip(index, 0, size - 1), inside | (mode == "clamp")


def bilinear_taps(
    uvs: np.ndarray, height: int, width: int, wrap: tuple[str, str]
) -> tuple[np.ndarray, np.ndarray]:
    """The four texels (flat indices, (n, 4)) and weights that a bilinear lookup reads."""
    x = uvs[:, 0] * width - 0.5
    y = uvs[:, 1] * height - 0.5
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    columns = [wrap_indices(x0 + k, width, wrap[0]) for k in (0, 1)]
    rows = [wrap_indices(y0 + k, height, wrap[1]) for k in (0, 1)]
    along_x = [share * has for share, (_, has) in zip((x0 + 1 - x, x - x0), columns, strict=True)]
    along_y = [share * has for share, (_, has) in zip((y0 + 1 - y, y - y0), rows, strict=True)]
    taps = [row * width + column for row, _ in rows for column, _ in columns]
    weights = [v * u for v in along_y for u in along_x]
    return np.stack(taps).T, np.stack(weights).T


def bilinear(image: np.ndarray, uvs: np.ndarray, wrap: tuple[str, str]) -> np.ndarray:
    height, width, channels = image.shape
    taps, weights = bilinear_taps(uvs, height, width, wrap)
    flat = image.reshape(-1, channels).astype(np.float64)
    found = np.empty((len(uvs), channels))
    for c in range(channels):
        plane = np.ascontiguousarray(flat[:, c])
        found[:, c] = sum(weights[:, k] * plane[taps[:, k]] for k in range(4))
    return found


def in_border(uvs: np.ndarray, wrap: tuple[str, str]) -> np.ndarray:
    """Points of weight 0: outside of the image along an axis that has a border."""
    outside = np.zeros(len(uvs), bool)
    for axis, mode in enumerate(wrap):
        if mode == "border":
            outside |= (uvs[:, axis] < 0) | (uvs[:, axis] > 1)
    return outside
