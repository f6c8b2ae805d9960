# SPDX-License-Identifier: GPL-3.0-or-later

"""Figure 7.7: errors of mipmaps against the mip value, as a picture."""

import colorsys
import math
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...bridge import lettering
from ...bridge.images import FloatArray
from ..choices import FILTERS
from .canvas import Canvas, Color
from .errors import ErrorCurves

WIDTH, HEIGHT = 1200, 800  # In pixels.
PAPER: Color = (1.0, 1.0, 1.0)
_INK: Color = (0.13, 0.13, 0.15)
_GRID: Color = (0.88, 0.88, 0.9)
_LEFT, _RIGHT, _BOTTOM, _TOP = 130, 40, 100, 90  # Margins.
_TEXT, _TITLE = 26.0, 32.0  # Font sizes.
_CAP_HEIGHT = 0.68  # Height of capitals relative to the font size.
_LINE, _DASHED_LINE, _DASH = 3.5, 1.5, 9.0
_TICK, _GAP = 8.0, 12.0
_ROW, _SAMPLE = 38.0, 52.0  # Height of a row of the legend, and length of its line sample.
_INTERVALS = 5  # Approximate number of intervals on the axis of errors.

# Colors that color-blind people can distinguish (Okabe and Ito), the first ones as in figure 7.7.
COLORS: dict[str, Color] = {
    "box": (0.0, 0.447, 0.698),
    "pam-box": (0.835, 0.369, 0.0),
    "pam-bilinear": (0.902, 0.624, 0.0),
    "pam-trilinear": (0.0, 0.62, 0.451),
    "tent": (0.337, 0.706, 0.914),
    "lanczos3": (0.8, 0.475, 0.655),
    "box-covered": (0.0, 0.25, 0.4),
    "tent-covered": (0.25, 0.45, 0.55),
    "lanczos3-covered": (0.5, 0.2, 0.4),
}


@dataclass(frozen=True)
class Axes:
    """The mapping of values to positions in the picture."""

    last_level: float
    top_error: float

    def position(self, mip_values: ArrayLike, errors: ArrayLike) -> NDArray[np.float64]:
        """Returns (..., 2) positions in pixels, from the lower left corner."""
        x = _LEFT + (WIDTH - _LEFT - _RIGHT) * np.asarray(mip_values) / self.last_level
        y = _BOTTOM + (HEIGHT - _BOTTOM - _TOP) * np.asarray(errors) / self.top_error
        return np.stack(np.broadcast_arrays(x, y), axis=-1)


def axes_of(curves: ErrorCurves) -> Axes:
    """Returns axes that contain the curves."""
    last = float(curves.mip_values[-1]) or 1.0
    step = _round_step(float(curves.errors.max()))
    return Axes(last, step * max(1, math.ceil(float(curves.errors.max()) / step - 1e-9)))


def draw(curves: ErrorCurves) -> FloatArray:
    """Returns (HEIGHT, WIDTH, 4) sRGB values, row 0 at the bottom. Main thread only.

    Solid lines are the errors, dashed ones the root mean squares over all mip values.
    """
    axes = axes_of(curves)
    canvas = Canvas(WIDTH, HEIGHT, PAPER)
    _draw_axes(canvas, axes, float(curves.errors.max()))
    for name, overall, errors in zip(curves.filters, curves.overall, curves.errors, strict=True):
        color = _color(name)
        ends = axes.position([0.0, axes.last_level], [overall, overall])
        canvas.line(ends, color, width=_DASHED_LINE, dashes=_DASH)
        canvas.line(axes.position(curves.mip_values, errors), color, width=_LINE)
    _draw_legend(canvas, curves)
    middle = (_LEFT + WIDTH - _RIGHT) / 2
    title = f"Error of the mipmaps of '{curves.image}' over the surface"
    _write(canvas, title, middle, HEIGHT - _TOP + 28, size=_TITLE, anchor=0.5, fit=WIDTH - 40)
    _write(canvas, "Mip value", middle, 22, anchor=0.5)
    _write(
        canvas, "RMSE, scene-linear", 34, (_BOTTOM + HEIGHT - _TOP) / 2, anchor=0.5, upwards=True
    )
    return canvas.pixels()


def _color(name: str) -> Color:
    """Returns the color of a filter; without an entry in `COLORS`, its name determines the hue."""
    hue = zlib.crc32(name.encode()) / 2**32
    return COLORS.get(name) or colorsys.hls_to_rgb(hue, 0.4, 0.6)


def _draw_axes(canvas: Canvas, axes: Axes, top: float) -> None:
    step = _round_step(top)
    stride = max(1, math.ceil(axes.last_level / 16))
    digits = max(0, -math.floor(math.log10(step)))
    for level in range(0, round(axes.last_level) + 1, stride):
        x, y = axes.position(level, 0.0)
        canvas.line([(x, y), (x, HEIGHT - _TOP)], _GRID, width=1.0)
        canvas.line([(x, y - _TICK), (x, y)], _INK, width=1.5)
        _write(canvas, str(level), x, y - _TICK - _GAP - _CAP_HEIGHT * _TEXT, anchor=0.5)
    for index in range(round(axes.top_error / step) + 1):
        x, y = axes.position(0.0, index * step)
        canvas.line([(x, y), (WIDTH - _RIGHT, y)], _GRID, width=1.0)
        canvas.line([(x - _TICK, y), (x, y)], _INK, width=1.5)
        label = f"{index * step:.{digits}f}"
        _write(canvas, label, x - _TICK - _GAP / 2, y - _CAP_HEIGHT * _TEXT / 2, anchor=1.0)
    corners = [(_LEFT, HEIGHT - _TOP), (_LEFT, _BOTTOM), (WIDTH - _RIGHT, _BOTTOM)]
    canvas.line(corners, _INK, width=1.5)


def _draw_legend(canvas: Canvas, curves: ErrorCurves) -> None:
    """Draws the legend at the lower right, where the curves, which rise, leave space below."""
    rows = [
        (FILTERS[name].label, _color(name), overall)
        for name, overall in zip(curves.filters, curves.overall, strict=True)
    ]
    texts = [f"{label}  ({overall:.3g} over all)" for label, _, overall in rows]
    width = max(lettering.outlines(text).high for text in texts) * _TEXT + _SAMPLE + 3 * _GAP
    top, left = _BOTTOM + _GAP + _ROW * len(rows), WIDTH - _RIGHT - _GAP - width
    canvas.rectangle((left, top - _ROW * len(rows)), (left + width, top), PAPER)
    for index, (text, (_, color, _)) in enumerate(zip(texts, rows, strict=True)):
        y = top - _ROW * (index + 0.5)
        start = left + _GAP
        canvas.line([(start, y), (start + _SAMPLE, y)], color, width=_LINE)
        _write(canvas, text, start + _SAMPLE + _GAP, y - _CAP_HEIGHT * _TEXT / 2)


def _write(
    canvas: Canvas,
    text: str,
    x: float,
    y: float,
    *,
    size: float = _TEXT,
    anchor: float = 0.0,
    upwards: bool = False,
    fit: float = math.inf,
) -> None:
    """Draws a line of text at a baseline point (x, y).

    Args:
        canvas: The canvas.
        text: The text.
        x: The horizontal position of the anchor.
        y: The vertical position of the baseline.
        size: The font size.
        anchor: The position of the anchor, as a share of the text's width.
        upwards: Whether the text runs upwards.
        fit: The largest width; the font is reduced to fit.
    """
    line = lettering.outlines(text)
    extent = line.high - line.low
    size = min(size, fit / max(extent, 1e-6))
    shift = -(line.low + anchor * extent) * size
    along, across = ((0.0, size), (-size, 0.0)) if upwards else ((size, 0.0), (0.0, size))
    start = (x, y + shift) if upwards else (x + shift, y)
    canvas.letters(line.letters, np.array([along, across, start]).T, _INK)


def _round_step(top: float) -> float:
    """Returns 1, 2 or 5 times a power of ten, for about `_INTERVALS` intervals in [0, top]."""
    if top <= 0.0:
        return 1.0
    rough = top / _INTERVALS
    power = 10.0 ** math.floor(math.log10(rough))
    return power * next(factor for factor in (1, 2, 5, 10) if factor * power >= rough * (1 - 1e-9))
