"""A small canvas: lines, rectangles and triangles with antialiased edges.

Positions are in pixels, with y upwards and row 0 at the bottom, as images have it. Colours are sRGB
values, and are blended in linear light.
"""

from collections.abc import Sequence

import numpy as np
import prefilter
from numpy.typing import ArrayLike, NDArray

from ...bridge.images import FloatArray

Color = tuple[float, float, float]
_REACH = 1.0  # How far antialiasing reaches from an edge, in pixels.


class Canvas:
    """An opaque picture that is drawn on."""

    def __init__(self, width: int, height: int, paper: Color) -> None:
        """Starts with an empty sheet."""
        self._light = np.empty((height, width, 3), np.float32)
        self._light[:] = _light(paper)

    def pixels(self) -> FloatArray:
        """Returns (height, width, 4) sRGB values."""
        height, width = self._light.shape[:2]
        rgba = np.ones((height, width, 4), np.float32)
        rgba[..., :3] = prefilter.to_srgb(self._light)
        return rgba

    def rectangle(self, low: Sequence[float], high: Sequence[float], color: Color) -> None:
        """Fills an upright rectangle."""
        box = self._box(np.array([low, high], float), 0.0)
        if box is None:
            return
        rows, columns = box
        x, y = (np.arange(part.start, part.stop) for part in (columns, rows))
        along_x = np.clip(np.minimum(x + 1, high[0]) - np.maximum(x, low[0]), 0, 1)
        along_y = np.clip(np.minimum(y + 1, high[1]) - np.maximum(y, low[1]), 0, 1)
        self._blend(box, np.outer(along_y, along_x), color)

    def line(
        self, points: ArrayLike, color: Color, *, width: float, dashes: float | None = None
    ) -> None:
        """Draws a polyline with round joints.

        Args:
            points: (n, 2) positions.
            color: Its colour.
            width: Its width.
            dashes: The length of dashes and of the gaps between them; None draws through.
        """
        path = np.asarray(points, float)
        if dashes is not None:
            pieces = _dashed(path, dashes)
        else:
            pieces = np.stack([path[:-1], path[1:]], axis=1)
        box = self._box(path, width / 2 + _REACH)
        if box is None or len(pieces) == 0:
            return
        coverage = np.zeros([part.stop - part.start for part in box])
        for piece in pieces:
            self._cover_piece(coverage, box, piece, width / 2)
        self._blend(box, coverage, color)

    def triangles(self, corners: NDArray[np.float64], color: Color) -> None:
        """Fills triangles that do not overlap, such as those of letters; (n, 3, 2) positions.

        The share of a pixel that they cover is a texel's weight: exact, whatever their size.
        """
        if len(corners) == 0:
            return
        box = self._box(corners.reshape(-1, 2), 0.0)
        if box is None:
            return
        rows, columns = box
        height, width = rows.stop - rows.start, columns.stop - columns.start
        local = corners - (columns.start, rows.start)
        flat = np.zeros((3 * len(local), 3))
        flat[:, :2] = local.reshape(-1, 2)
        surface = prefilter.Surface(
            flat, np.arange(len(flat), dtype=np.int32).reshape(-1, 3), local / (width, height)
        )
        u, v = local[:, 1] - local[:, 0], local[:, 2] - local[:, 0]
        area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2
        if area == 0.0:
            return
        weights = prefilter.texel_weights(surface, width, height, wrap="border", threads=1)
        self._blend(box, weights * (area / (width * height)), color)

    def _box(self, points: NDArray[np.float64], reach: float) -> tuple[slice, slice] | None:
        """Returns the rows and columns around points, or None if they are off the sheet."""
        height, width = self._light.shape[:2]
        low = np.maximum(np.floor(points.min(axis=0) - reach).astype(int), 0)
        high = np.minimum(np.ceil(points.max(axis=0) + reach).astype(int), (width, height))
        if np.any(low >= high):
            return None
        return slice(int(low[1]), int(high[1])), slice(int(low[0]), int(high[0]))

    def _cover_piece(
        self,
        coverage: NDArray[np.float64],
        box: tuple[slice, slice],
        piece: NDArray[np.float64],
        half: float,
    ) -> None:
        near = self._box(piece, half + _REACH)
        if near is None:
            return
        rows, columns = near
        x = np.arange(columns.start, columns.stop) + 0.5 - piece[0, 0]
        y = np.arange(rows.start, rows.stop)[:, None] + 0.5 - piece[0, 1]
        along = piece[1] - piece[0]
        length = float(along @ along)
        place = np.clip((x * along[0] + y * along[1]) / length, 0, 1) if length > 0 else 0.0
        distance = np.hypot(x - place * along[0], y - place * along[1])
        part = coverage[
            rows.start - box[0].start : rows.stop - box[0].start,
            columns.start - box[1].start : columns.stop - box[1].start,
        ]
        np.maximum(part, np.clip(half + 0.5 - distance, 0, 1), out=part)

    def _blend(self, box: tuple[slice, slice], coverage: ArrayLike, color: Color) -> None:
        share = np.asarray(coverage, np.float32)[..., None]
        self._light[box] += share * (_light(color) - self._light[box])


def _light(color: Color) -> FloatArray:
    return prefilter.to_linear(np.array([[color]], np.float32))[0, 0]


def _dashed(path: NDArray[np.float64], dash: float) -> NDArray[np.float64]:
    """Returns the straight pieces (n, 2, 2) of the dashes along a path."""
    lengths = np.hypot(*np.diff(path, axis=0).T)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    cuts = np.unique(np.concatenate([ends, np.arange(0.0, ends[-1], dash)]))
    points = np.stack([np.interp(cuts, ends, path[:, axis]) for axis in (0, 1)], axis=1)
    middle = (cuts[:-1] + cuts[1:]) / 2
    drawn = np.floor(middle / dash).astype(int) % 2 == 0
    return np.stack([points[:-1], points[1:]], axis=1)[drawn]
