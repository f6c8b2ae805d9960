# SPDX-License-Identifier: GPL-3.0-or-later

"""Gradients of shapes, and the encoding of their colors."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from .... import _native
from ...affine import Matrix, as_rows, compose
from ...shape import Shape
from .colors import Color

# Largest error of linear interpolation between stops, as a fraction of encoded white.
_TOLERANCE = 1.0 / 1020.0


class Colors:
    """The encoding of colors in shapes.

    Attributes:
        is_linear: Whether red, green and blue are decoded to scene-linear values.
        is_stepped: Whether opacities are rounded to multiples of 1/255, as in browsers.
    """

    def __init__(self, is_linear: bool, is_stepped: bool) -> None:
        self.is_linear = is_linear
        self.is_stepped = is_stepped

    def opacity(self, opacity: float) -> float:
        """Returns an opacity, rounded if `is_stepped`."""
        return math.floor(255.0 * opacity + 0.5) / 255.0 if self.is_stepped else opacity

    def premultiplied(self, colors: np.ndarray) -> list[tuple[float, ...]]:
        """Encodes (n, 4) straight sRGB colors and premultiplies them by alpha."""
        values = np.asarray(colors, np.float64)
        rgb = values[:, :3]
        if self.is_linear:
            image = np.ascontiguousarray(rgb[None], np.float32)
            rgb = _native.decode_srgb(image, 1)[0].astype(np.float64)
        rows = np.concatenate([rgb * values[:, 3:], values[:, 3:]], axis=1)
        return [tuple(row) for row in rows.tolist()]

    def between(self, first: Color, last: Color) -> np.ndarray:
        """Samples a gradient segment densely enough for linear interpolation.

        SVG interpolates encoded colors with straight alpha. Decoding and premultiplying make curves
        of these lines. Returns (n, 4) at equal steps, both ends included.
        """
        ends = np.array([first, last])
        change = np.abs(ends[1] - ends[0])
        # The error of a chord is an eighth of the second derivative. For the product with alpha
        # that derivative is twice the product of the slopes. For a decoded color, compared after
        # encoding, it is largest where the power segment begins: 1.4 / (0.04045 + 0.055).
        squares = change[:3].max() * change[3] / 4.0
        if self.is_linear:
            squares = 2.4 * squares + change[:3].max() * change[:3].max() * (1.4 / 0.09545) / 8.0
        count = max(1, math.ceil(math.sqrt(squares / _TOLERANCE)))
        shares = np.linspace(0.0, 1.0, count + 1)[:, None]
        colors: np.ndarray = ends[0] * (1.0 - shares) + ends[1] * shares
        return colors


@dataclass(frozen=True)
class Gradient:
    """A gradient in the units of the outline that it paints, with encoded stops."""

    is_radial: bool
    numbers: tuple[float, ...]
    stops: list[tuple[float, tuple[float, ...]]]
    spread: str
    matrix: Matrix

    def apply(self, shape: Shape, matrix: Matrix, opacity: float) -> None:
        """Sets the gradient of a shape that `matrix` transformed, times an opacity."""
        transform = as_rows(compose(matrix, self.matrix))
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


def sample_stops(
    stops: Sequence[Stop], colors: Colors
) -> Iterator[tuple[float, tuple[float, ...]]]:
    """Yields stops of a shape, with more of them where interpolation would be inexact."""
    for index, stop in enumerate(stops):
        following = stops[index + 1] if index + 1 < len(stops) else stop
        between = np.array([stop.color])
        if following.offset > stop.offset:
            between = colors.between(stop.color, following.color)[:-1]
        for k, color in enumerate(colors.premultiplied(between)):
            yield stop.offset + (following.offset - stop.offset) * k / len(between), color
