# SPDX-License-Identifier: GPL-3.0-or-later

"""Shapes with a thin part: plates, rods, rings, gratings, cones and a fan guard."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.solids import Solid, box, random_rotation, torus

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ThinShape:
    """A shape around the origin, with its properties.

    Attributes:
        solid: In cells.
        parts: The number of connected parts.
        genus: The genus of all parts together.
        depth: The depth of an octree, with cells of size 1, that holds it in any pose.
    """

    solid: Solid
    parts: int
    genus: int
    depth: int = 6


def plate(thickness: float) -> ThinShape:
    """A plate of 40 x 30."""
    half = thickness / 2
    return ThinShape(box((-20, -15, -half), (20, 15, half)), 1, 0)


def rod(thickness: float) -> ThinShape:
    """A prism of twelve sides."""
    return ThinShape(prism(thickness / 2, thickness / 2, 40.0, 12), 1, 0)


def ring(thickness: float) -> ThinShape:
    """A torus."""
    return ThinShape(torus(15.0, thickness / 2, 48, 10), 1, 1)


def cone(thickness: float) -> ThinShape:
    """A cone that is three times as thick at its base."""
    return ThinShape(prism(3 * thickness, 0.0, 40.0, 24), 1, 0)


def grating(thickness: float) -> ThinShape:
    """Bars that cross, five along each side, with gaps of five cells."""
    widths = [thickness if k % 2 == 0 else 5.0 for k in range(9)]
    places = np.concatenate([[0.0], np.cumsum(widths)])
    places -= places[-1] / 2
    is_bar = np.arange(9) % 2 == 0
    is_filled = is_bar[:, None] | is_bar[None, :]
    x, y = np.meshgrid(places, places, indexing="ij")
    return ThinShape(_extruded(x, y, is_filled, thickness), 1, 16)


def fan_guard(thickness: float) -> ThinShape:
    """A square frame with a hole in each corner; in it three rings and a hub on four bars."""
    frame, opening, bars, segments = 44.0, 40.0, 4, 12
    half = thickness / 2
    radii = np.array([r + side for r in (6.0, 14.5, 23.0, 31.5) for side in (-half, half)])
    rows = [_around(r, half, bars, segments) for r in (*radii, opening)]
    outer = rows[-1] * (frame / np.abs(rows[-1]).max(axis=1))[:, None]
    rows += [rows[-1] + share * (outer - rows[-1]) for share in (0.5, 0.8, 1.0)]
    points = np.array([np.concatenate([row, row[:1]]) for row in rows])
    segment = np.arange(bars * segments) % segments
    is_filled = np.ones((len(rows) - 1, bars * segments), bool)
    is_filled[1 : len(radii) : 2] = segment == 0
    is_filled[-2] = segment != segments // 2
    solid = _extruded(points[..., 0], points[..., 1], is_filled, thickness)
    return ThinShape(solid, 1, 21, depth=7)


SHAPES: dict[str, Callable[[float], ThinShape]] = {
    "plate": plate,
    "rod": rod,
    "ring": ring,
    "grating": grating,
    "cone": cone,
    "fan guard": fan_guard,
}


def posed(shape: ThinShape, seed: int, cells: int) -> Solid:
    """Turned and moved in a cube of so many cells; along the axes, where cells meet, for seed 0."""
    if seed == 0:
        return shape.solid.transformed(np.eye(3), np.full(3, cells / 2))
    shift = np.random.default_rng(seed).uniform(-0.5, 0.5, 3)
    return shape.solid.transformed(random_rotation(seed), cells / 2 + shift)


def _around(radius: float, half: float, bars: int, segments: int) -> Array:
    """Points of a circle: at both sides of each bar, and between."""
    quarter = 2 * np.pi / bars
    bar = np.arcsin(half / radius)
    steps = np.concatenate([[-bar], np.linspace(bar, quarter - bar, segments)[:-1]])
    angles = (quarter * np.arange(bars)[:, None] + steps).ravel()
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _extruded(x: Array, y: Array, is_filled: NDArray[np.bool_], height: float) -> Solid:
    """The solid over cells of a grid of points; its last column may be at the first one."""
    rows, columns = is_filled.shape
    wraps = np.allclose(x[:, 0], x[:, -1]) and np.allclose(y[:, 0], y[:, -1])
    around = np.zeros((rows + 2, columns + 2), bool)
    around[1:-1, 1:-1] = is_filled
    if wraps:
        around[:, 0], around[:, -1] = around[:, -2], around[:, 1]
    vertex = np.arange(2 * x.size).reshape(*x.shape, 2)
    if wraps:
        vertex[:, -1] = vertex[:, 0]
    quads = []
    for i, j in np.argwhere(is_filled):
        low, high = (vertex[[i, i + 1, i + 1, i], [j, j, j + 1, j + 1], z] for z in (0, 1))
        quads += [low[::-1], high]
        beside = (around[i + 1, j], around[i + 2, j + 1], around[i + 1, j + 2], around[i, j + 1])
        for k, has_next in enumerate(beside):
            if not has_next:
                m = (k + 1) % 4
                quads.append(np.array([low[k], low[m], high[m], high[k]]))
    flat = np.repeat(np.stack([x, y], axis=-1).reshape(-1, 2), 2, axis=0)
    lift = np.tile([-height / 2, height / 2], x.size)
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return Solid(np.column_stack([flat, lift]), triangles)


def prism(low: float, high: float, length: float, sides: int) -> Solid:
    """Between two polygons around the z axis; the upper one may be a point."""
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
