# SPDX-License-Identifier: GPL-3.0-or-later

"""Gradients of shapes, and colors as shapes have them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from .... import _native
from ...affine import Matrix, multiplied
from ...shape import Shape
from .colors import Color

# How far straight lines between stops may be off, in shares of white as it is encoded.
_TOLERANCE = 1.0 / 1020.0


class Colors:
    """Colors as shapes have them.

    Attributes:
        is_linear: Whether red, green and blue are decoded to scene-linear values.
        is_stepped: Whether opacities are rounded to steps of a 255th, as browsers have them.
    """

    def __init__(self, is_linear: bool, is_stepped: bool) -> None:
        self.is_linear = is_linear
        self.is_stepped = is_stepped

    def opacity(self, opacity: float) -> float:
        """An opacity as it is kept."""
        return math.floor(255.0 * opacity + 0.5) / 255.0 if self.is_stepped else opacity

    def premultiplied(self, colors: np.ndarray) -> list[tuple[float, ...]]:
        """Colors (n, 4) of a file, multiplied by their alpha."""
        values = np.asarray(colors, np.float64)
        rgb = values[:, :3]
        if self.is_linear:
            image = np.ascontiguousarray(rgb[None], np.float32)
            rgb = _native.decode_srgb(image, 1)[0].astype(np.float64)
        rows = np.concatenate([rgb * values[:, 3:], values[:, 3:]], axis=1)
        return [tuple(row) for row in rows.tolist()]

    def between(self, first: Color, last: Color) -> np.ndarray:
        """Colors from one stop to the next, so close that straight lines between them will do.

        A file has the colors change in a straight line as they are encoded, and not multiplied by
        alpha. Either makes a curve of it: (n, 4), at equal distances, both ends included.
        """
        ends = np.array([first, last])
        change = np.abs(ends[1] - ends[0])
        # A curve is off from a chord by an eighth of its second derivative. That of the product is
        # twice the product of the slopes. That of the decoded color, as seen when encoded again,
        # is largest where its power begins: 1.4 / (0.04045 + 0.055).
        squares = change[:3].max() * change[3] / 4.0
        if self.is_linear:
            squares = 2.4 * squares + change[:3].max() * change[:3].max() * (1.4 / 0.09545) / 8.0
        count = max(1, math.ceil(math.sqrt(squares / _TOLERANCE)))
        shares = np.linspace(0.0, 1.0, count + 1)[:, None]
        colors: np.ndarray = ends[0] * (1.0 - shares) + ends[1] * shares
        return colors


@dataclass(frozen=True)
class Gradient:
    """A gradient of the colors that shapes have, in the units of what it paints."""

    is_radial: bool
    numbers: tuple[float, ...]
    stops: list[tuple[float, tuple[float, ...]]]
    spread: str
    matrix: Matrix

    def apply(self, shape: Shape, matrix: Matrix, opacity: float) -> None:
        """Paints a shape which `matrix` has carried to where it is, with an opacity."""
        a, b, c, d, e, f = multiplied(matrix, self.matrix)
        transform = np.array([[a, c, e], [b, d, f]])
        stops = [(at, tuple(opacity * value for value in color)) for at, color in self.stops]
        if self.is_radial:
            cx, cy, r, fx, fy, fr = self.numbers
            shape.radial_gradient(
                (cx, cy),
                r,
                stops,
                focus=(fx, fy),
                focus_radius=fr,
                spread=self.spread,
                transform=transform,
            )
        else:
            x1, y1, x2, y2 = self.numbers
            shape.linear_gradient(
                (x1, y1), (x2, y2), stops, spread=self.spread, transform=transform
            )


@dataclass(frozen=True)
class Stop:
    offset: float
    color: Color


def pieces_between(
    stops: Sequence[Stop], colors: Colors
) -> Iterator[tuple[float, tuple[float, ...]]]:
    """Yields the stops of a shape: those of a file, and others where straight lines will not do."""
    for index, stop in enumerate(stops):
        following = stops[index + 1] if index + 1 < len(stops) else stop
        between = np.array([stop.color])
        if following.offset > stop.offset:
            between = colors.between(stop.color, following.color)[:-1]
        for k, color in enumerate(colors.premultiplied(between)):
            yield stop.offset + (following.offset - stop.offset) * k / len(between), color
