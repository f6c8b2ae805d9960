# SPDX-License-Identifier: GPL-3.0-or-later

"""The demonstrations' models: a stone with six charts, a broken stone, and a knot of points."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_CHARTS = (
    *((0.02, 0.02, 0.46), (0.52, 0.02, 0.22), (0.78, 0.02, 0.20)),
    *((0.02, 0.52, 0.30), (0.36, 0.52, 0.14), (0.54, 0.36, 0.42)),
)
"""The left, the bottom and the side of each chart; texel densities differ by a factor of three."""
_MARGIN = 2  # Width of the paint around a chart, in texels.
_INK, _CREAM, _RUST, _TEAL = (
    *((0.06, 0.07, 0.10), (0.94, 0.89, 0.76), (0.78, 0.25, 0.14)),
    (0.08, 0.42, 0.45),
)


@dataclass(frozen=True)
class Model:
    """A mesh of quads.

    Attributes:
        points: (n, 3).
        quads: (m, 4) indices, counterclockwise from outside.
        uvs: (m, 4, 2); None for none.
    """

    points: Array
    quads: NDArray[np.int64]
    uvs: Array | None = None


def stone(cells: int = 24) -> Model:
    """Returns a closed mesh of six charts.

    Args:
        cells: The number of quads along each side of a chart.
    """
    steps = np.linspace(0.0, 1.0, cells + 1)
    s, t = (grid.ravel() for grid in np.meshgrid(steps, steps))
    row = np.arange(cells * (cells + 1)).reshape(cells, cells + 1)[:, :-1].ravel()
    quads = row[:, None] + np.array([0, 1, cells + 2, cells + 1])
    points = np.concatenate([_on_stone(side, s, t) for side in range(6)])
    corners = np.concatenate([quads + side * len(s) for side in range(6)])
    chart_uvs = np.stack([s, t], axis=-1)[quads]
    uvs = [np.array([left, low]) + size * chart_uvs for left, low, size in _CHARTS]
    # Adjacent charts share their boundary vertices on the stone.
    _, first, same = np.unique(points.round(6), axis=0, return_index=True, return_inverse=True)
    return Model(points[first], same.reshape(-1)[corners], np.concatenate(uvs))


def paint(size: int = 512) -> NDArray[np.float32]:
    """Returns (size, size, 4): a pattern that continues across charts, on black."""
    pixels = np.zeros((size, size, 4), np.float32)
    pixels[..., 3] = 1.0
    centers = (np.arange(size) + 0.5) / size
    for side, (left, low, length) in enumerate(_CHARTS):
        near = _MARGIN / size
        columns, rows = (
            np.flatnonzero((centers > start - near) & (centers < start + length + near))
            for start in (left, low)
        )
        s, t = np.meshgrid((centers[columns] - left) / length, (centers[rows] - low) / length)
        colors = _pattern(_directions(side, s.ravel(), t.ravel()))
        pixels[np.ix_(rows, columns, np.arange(3))] = colors.reshape(len(rows), len(columns), 3)
    return pixels


def broken_stone(seed: int = 1) -> Model:
    """Returns a stone with holes, and an open, inside-out ring through it."""
    whole = stone()
    rng = np.random.default_rng(seed)
    stone_quads = whole.quads[rng.random(len(whole.quads)) > 0.06]
    around, across = np.meshgrid(np.arange(64), np.arange(24), indexing="ij")
    angle, turn = 2 * np.pi * around.ravel() / 64, 2 * np.pi * across.ravel() / 24
    radius = 0.95 + 0.24 * np.cos(turn)
    ring = np.stack([radius * np.cos(angle), 0.24 * np.sin(turn), radius * np.sin(angle)], axis=-1)
    ring[:, 0] += 0.55
    middle = np.array([0.3, 0.0, 0.0])
    steps = ((0, 0), (1, 0), (1, 1), (0, 1))
    corners = [(around + i) % 64 * 24 + (across + j) % 24 for i, j in steps]
    quads = np.stack([corner.ravel() for corner in corners], axis=-1)
    quads = quads[rng.random(len(quads)) > 0.04]
    return Model(
        np.concatenate([whole.points, ring]) - middle,
        np.concatenate([stone_quads, quads + len(whole.points)]),
    )


def knot(count: int = 20_000, seed: int = 1) -> tuple[Array, Array, Array]:
    """Returns noisy points on a tube around a trefoil knot, like those of a scanner.

    Args:
        count: The number of points.
        seed: The seed of the random numbers.

    Returns:
        Positions, normals and colors, (count, 3) each.
    """
    rng = np.random.default_rng(seed)
    t, turn = 2 * np.pi * rng.random((2, count))
    along = np.stack(
        [np.cos(t) + 4 * np.cos(2 * t), -np.sin(t) + 4 * np.sin(2 * t), -3 * np.cos(3 * t)], axis=-1
    )
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    center = np.stack(
        [np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=-1
    )
    side = np.cross(along, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    up = np.cross(side, along)
    normals = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * up
    points = 0.36 * center + 0.24 * normals + rng.normal(scale=0.006, size=(count, 3))
    # Rotates the knot upright, facing the front view.
    axes = [0, 2, 1]
    signs = np.array([1.0, -1.0, 1.0])
    return points[:, axes] * signs, normals[:, axes] * signs, _pattern(0.5 * points)


def _directions(side: int, s: Array, t: Array) -> Array:
    """Returns unit vectors for coordinates in [0, 1] on a side of a cube."""
    # Equal angles give quads of about equal size.
    a, b = (np.tan(np.pi / 4 * (2.0 * coordinate - 1.0)) for coordinate in (s, t))
    axis, is_low = divmod(side, 2)
    sign = -1.0 if is_low else 1.0
    vectors = np.empty((len(a), 3))
    vectors[:, axis], vectors[:, (axis + 1) % 3], vectors[:, (axis + 2) % 3] = sign, sign * a, b
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _on_stone(side: int, s: Array, t: Array) -> Array:
    directions = _directions(side, s, t)
    x, y, z = directions.T
    height = 1.0 + 0.10 * np.sin(3.0 * x + 1.0) * np.cos(2.5 * z) + 0.07 * np.sin(4.0 * y)
    return directions * height[:, None]


def _pattern(points: Array) -> Array:
    """Returns sRGB colors at points: stripes and spots with outlines."""
    x, y, z = points.T
    stripes = np.sin(11.0 * z + 2.5 * np.sin(3.0 * x) + 2.0 * np.cos(4.0 * y))
    spots = np.sin(9.0 * x) * np.sin(9.0 * y + 1.0) * np.sin(9.0 * z + 2.0)
    colors = np.where((stripes > 0.0)[:, None], _CREAM, _TEAL)
    colors = np.where((spots > 0.35)[:, None], _RUST, colors)
    edges = (np.abs(stripes) < 0.15) | (np.abs(spots - 0.35) < 0.06)
    return np.where(edges[:, None], _INK, colors)
