# SPDX-License-Identifier: GPL-3.0-or-later

"""Shapes with a thin part: plates, rods, rings, gratings and cones, about 40 cells large."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bench.solids import Solid, box, random_rotation, torus


@dataclass(frozen=True)
class ThinShape:
    """A shape around the origin, and what it is.

    Attributes:
        solid: In cells.
        parts: What hangs together.
        genus: Of all parts.
    """

    solid: Solid
    parts: int
    genus: int


def plate(thickness: float) -> ThinShape:
    """A plate of 40 x 30."""
    half = thickness / 2
    return ThinShape(box((-20, -15, -half), (20, 15, half)), 1, 0)


def rod(thickness: float) -> ThinShape:
    """A prism of twelve sides."""
    return ThinShape(_cone(thickness / 2, thickness / 2, 40.0, 12), 1, 0)


def ring(thickness: float) -> ThinShape:
    """A torus."""
    return ThinShape(torus(15.0, thickness / 2, 48, 10), 1, 1)


def cone(thickness: float) -> ThinShape:
    """A cone that is three times as thick at its base."""
    return ThinShape(_cone(3 * thickness, 0.0, 40.0, 24), 1, 0)


def grating(thickness: float) -> ThinShape:
    """Bars that cross, five along each side, with gaps of five cells."""
    widths = [thickness if k % 2 == 0 else 5.0 for k in range(9)]
    places = np.concatenate([[0.0], np.cumsum(widths)])
    is_bar = np.zeros((11, 11), bool)
    bars = np.arange(9) % 2 == 0
    is_bar[1:-1, 1:-1] = bars[:, None] | bars[None, :]
    vertex = np.arange(2 * 100).reshape(10, 10, 2)
    quads = []
    for i, j in np.argwhere(is_bar[1:-1, 1:-1]):
        low, high = (vertex[[i, i + 1, i + 1, i], [j, j, j + 1, j + 1], z] for z in (0, 1))
        quads += [low[::-1], high]
        beside = (is_bar[i + 1, j], is_bar[i + 2, j + 1], is_bar[i + 1, j + 2], is_bar[i, j + 1])
        for k, is_filled in enumerate(beside):
            if not is_filled:
                m = (k + 1) % 4
                quads.append(np.array([low[k], low[m], high[m], high[k]]))
    x, y, z = np.meshgrid(places, places, [-thickness / 2, thickness / 2], indexing="ij")
    middle = places[-1] / 2
    positions = np.stack([x - middle, y - middle, z], axis=-1).reshape(-1, 3)
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return ThinShape(Solid(positions, triangles), 1, 16)


SHAPES: dict[str, Callable[[float], ThinShape]] = {
    "plate": plate,
    "rod": rod,
    "ring": ring,
    "grating": grating,
    "cone": cone,
}


def posed(shape: ThinShape, seed: int, cells: int) -> Solid:
    """Turned and moved in a cube of so many cells; along the axes, where cells meet, for seed 0."""
    if seed == 0:
        return shape.solid.transformed(np.eye(3), np.full(3, cells / 2))
    shift = np.random.default_rng(seed).uniform(-0.5, 0.5, 3)
    return shape.solid.transformed(random_rotation(seed), cells / 2 + shift)


def _cone(low: float, high: float, length: float, sides: int) -> Solid:
    """Between two discs around the z axis; the upper one may be a point."""
    turn = np.arange(sides) * 2 * np.pi / sides
    ring = np.stack([np.cos(turn), np.sin(turn), np.zeros(sides)], axis=1)
    lift = np.array([0.0, 0.0, length / 2])
    rings = [low * ring - lift, high * ring + lift] if high else [low * ring - lift, lift[None]]
    positions = np.concatenate([*rings, -lift[None], lift[None]])
    i = np.arange(sides)
    j = (i + 1) % sides
    bottom, top = len(positions) - 2, len(positions) - 1
    caps = [np.stack([np.full(sides, bottom), j, i], axis=1)]
    if high:
        caps.append(np.stack([np.full(sides, top), sides + i, sides + j], axis=1))
        walls = [np.stack([i, j, sides + j], axis=1), np.stack([i, sides + j, sides + i], axis=1)]
    else:
        walls = [np.stack([i, j, np.full(sides, sides)], axis=1)]
    return Solid(positions, np.concatenate([*walls, *caps]))
