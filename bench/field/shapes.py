# SPDX-License-Identifier: GPL-3.0-or-later

"""Shapes with closed forms, which clouds are sampled from and surfaces are compared with."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Shape:
    """A sphere, a torus around z, or the walls of a box seen from within.

    Attributes:
        kind: "sphere", "torus" or "room".
        center: (x, y, z).
        sizes: Radius of a sphere; large and small radius of a torus; half sides of a room.
    """

    kind: str
    center: tuple[float, ...]
    sizes: tuple[float, ...]

    @staticmethod
    def of(truth: Mapping[str, Any]) -> "Shape":
        """Returns the shape that a generator wrote down."""
        return Shape(truth["kind"], tuple(truth["center"]), tuple(truth["sizes"]))

    def written(self) -> dict[str, Any]:
        """Returns the data that `of` reads."""
        return {"kind": self.kind, "center": list(self.center), "sizes": list(self.sizes)}

    def distances(self, points: Floats) -> Floats:
        """Returns the distances of points from the surface."""
        return np.abs(self._signed(points))

    def outward(self, points: Floats) -> Floats:
        """Returns the directions toward the scanner: out of solids, and into rooms."""
        step = 1e-4 * max(self.sizes)
        axes = step * np.eye(3)
        slopes = [self._signed(points + axis) - self._signed(points - axis) for axis in axes]
        normals = np.stack(slopes, axis=1) * (-1 if self.kind == "room" else 1)
        return normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]

    def sample(self, count: int, random: np.random.Generator) -> Floats:
        """Returns points spread over the surface."""
        if self.kind == "torus":
            return self._sample_torus(count, random)
        directions = random.normal(size=(count, 3))
        if self.kind == "sphere":
            directions /= np.linalg.norm(directions, axis=1)[:, None]
            return np.asarray(self.center) + self.sizes[0] * directions
        half = np.asarray(self.sizes)
        return np.asarray(self.center) + directions * (half / np.abs(directions)).min(1)[:, None]

    def area(self) -> float:
        """Returns the area of the surface."""
        if self.kind == "sphere":
            return 4 * np.pi * self.sizes[0] ** 2
        if self.kind == "torus":
            return 4 * np.pi**2 * self.sizes[0] * self.sizes[1]
        a, b, c = self.sizes
        return 8 * (a * b + b * c + c * a)

    def _signed(self, points: Floats) -> Floats:
        local = points - np.asarray(self.center)
        if self.kind == "sphere":
            return np.linalg.norm(local, axis=1) - self.sizes[0]
        if self.kind == "torus":
            ring = np.hypot(local[:, 0], local[:, 1]) - self.sizes[0]
            return np.hypot(ring, local[:, 2]) - self.sizes[1]
        beyond = np.abs(local) - np.asarray(self.sizes)
        outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
        return outside + np.minimum(beyond.max(axis=1), 0)

    def _sample_torus(self, count: int, random: np.random.Generator) -> Floats:
        large, small = self.sizes
        u, v = random.uniform(0, 2 * np.pi, (2, 4 * count))
        # More points lie outside than inside of the ring: by rejection.
        keep = random.random(4 * count) * (large + small) < large + small * np.cos(v)
        u, v = u[keep][:count], v[keep][:count]
        ring = large + small * np.cos(v)
        local = np.stack([ring * np.cos(u), ring * np.sin(u), small * np.sin(v)], axis=1)
        return np.asarray(self.center) + local
