# SPDX-License-Identifier: GPL-3.0-or-later

"""A canvas for figures: lines, rectangles and letters, drawn by `prefilter.rasterize`.

Positions are in pixels, with y upwards and row 0 at the bottom, as in Blender's images. Colors are
sRGB values, blended in linear light.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import prefilter
from numpy.typing import ArrayLike, NDArray
from prefilter.workflows.shapes.outlines import add_contour

from ...bridge.images import FloatArray

Color = tuple[float, float, float]


class Canvas:
    """An opaque picture; later shapes cover earlier ones."""

    def __init__(self, width: int, height: int, paper: Color) -> None:
        """Creates an empty canvas with a background color."""
        self._size = (width, height)
        self._paper = _light(paper)
        self._shapes: list[prefilter.Shape] = []

    def pixels(self) -> FloatArray:
        """Returns (height, width, 4) sRGB values."""
        width, height = self._size
        light: NDArray[Any]
        if not self._shapes:
            light = np.empty((height, width, 4), np.float32)
            light[:] = self._paper
        else:
            light = prefilter.rasterize(
                self._shapes, width, height, background=self._paper, overlap="cover"
            )
        return prefilter.to_srgb(light)

    def rectangle(self, low: Sequence[float], high: Sequence[float], color: Color) -> None:
        """Fills an upright rectangle."""
        shape = self._shape(color)
        corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
        shape.add_polygon(np.array(corners, np.float64))
        self._shapes.append(shape)

    def line(
        self, points: ArrayLike, color: Color, *, width: float, dashes: float | None = None
    ) -> None:
        """Draws a polyline with round joints.

        Args:
            points: (n, 2) positions.
            color: Its color.
            width: Its width.
            dashes: The length of dashes and of the gaps between them; None for a solid line.
        """
        shape = self._shape(color)
        (first, *others) = np.asarray(points, np.float64).tolist()
        shape.move_to(*first)
        for point in others:
            shape.line_to(*point)
        pattern = () if dashes is None else (dashes, dashes)
        cap = "butt" if dashes is not None else "round"
        self._shapes.append(shape.stroked(width, join="round", cap=cap, dashes=pattern))

    def letters(
        self,
        letters: Iterable[Iterable[NDArray[np.float64]]],
        matrix: NDArray[np.float64],
        color: Color,
    ) -> None:
        """Fills letters.

        Args:
            letters: The letters of a `bridge.lettering.Lettering`.
            matrix: (2, 3), from their space to the canvas.
            color: Their color.
        """
        placed = np.vstack([matrix, [0.0, 0.0, 1.0]]).T
        for letter in letters:
            shape = self._shape(color)
            for contour in letter:
                add_contour(shape, contour @ placed)
            self._shapes.append(shape)

    def _shape(self, color: Color) -> "prefilter.Shape":
        shape = prefilter.Shape()
        shape.color = _light(color)
        return shape


def _light(color: Color) -> tuple[float, ...]:
    values = prefilter.to_linear(np.array([[(*color, 1.0)]], np.float32))
    return tuple(float(value) for value in values[0, 0])
