# SPDX-License-Identifier: GPL-3.0-or-later

"""Points with normals, sampled from known surfaces."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cloud:
    """Points of a surface.

    Attributes:
        points: (n, 3).
        normals: (n, 3), outward.
        distance: Returns the distances of points, (m, 3), from the surface; positive outside.
    """

    points: Array
    normals: Array
    distance: Callable[[Array], Array]

    @property
    def both(self) -> tuple[Array, Array]:
        return self.points, self.normals


def sphere(
    count: int, radius: float = 1.0, center: ArrayLike = (0.0, 0.0, 0.0), seed: int = 0
) -> Cloud:
    middle = np.asarray(center)
    normals = _directions(count, seed)
    return Cloud(
        middle + radius * normals,
        normals,
        lambda p: np.linalg.norm(p - middle, axis=1) - radius,
    )


def torus(count: int, radius: float = 1.0, tube: float = 0.4, seed: int = 0) -> Cloud:
    """Points of uniform density over the area, by rejection."""
    rng = np.random.default_rng(seed)
    u, v, w = rng.random((3, 3 * count))
    v *= 2 * np.pi
    kept = w < (radius + tube * np.cos(v)) / (radius + tube)
    u, v = 2 * np.pi * u[kept][:count], v[kept][:count]
    ring = np.stack([np.cos(u), np.sin(u), np.zeros_like(u)], axis=1)
    normals = np.cos(v)[:, None] * ring + np.sin(v)[:, None] * np.array([0.0, 0.0, 1.0])
    return Cloud(
        radius * ring + tube * normals,
        normals,
        lambda p: np.hypot(np.hypot(p[:, 0], p[:, 1]) - radius, p[:, 2]) - tube,
    )


def _directions(count: int, seed: int) -> Array:
    found = np.random.default_rng(seed).normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)
