# SPDX-License-Identifier: GPL-3.0-or-later

"""Layered color glyphs: the tables COLR, versions 0 and 1, and CPAL."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

from ... import _native
from ..affine import IDENTITY, Matrix, compose, translation

Color: TypeAlias = tuple[float, float, float, float]

_TEXT_COLOR = 0xFFFF
_SPREADS = ("pad", "repeat", "reflect")
MAX_PAINTS = 4096
MAX_DEPTH = 32
# CompositeMode numbers of CSS blend modes.
_BLEND_MODES = {
    **{13: "screen", 14: "overlay", 15: "darken", 16: "lighten", 17: "color-dodge"},
    **{18: "color-burn", 19: "hard-light", 20: "soft-light", 21: "difference", 22: "exclusion"},
    **{23: "multiply", 24: "hue", 25: "saturation", 26: "color", 27: "luminosity"},
}
_CLEAR, _SOURCE, _BACKDROP, _OVER, _UNDER, _SOURCE_IN, _BACKDROP_IN = range(7)


class UnknownPaintError(ValueError):
    """A paint is not supported; the message names it."""


@dataclass(frozen=True, slots=True)
class ColorStop:
    """A gradient stop, or a single color.

    Attributes:
        offset: Position in the gradient.
        color: Palette color; None for the text's color.
        alpha: Multiplies the color's alpha.
    """

    offset: float
    color: Color | None
    alpha: float


@dataclass(frozen=True, slots=True)
class ColorFill:
    """A painted glyph, in font units, y upwards.

    Attributes:
        glyph: Glyph index; None for the whole plane.
        matrix: From the glyph's units to those of the enclosing group.
        kind: "solid", "linear" or "radial".
        numbers: Gradient geometry: both ends; or center, radius, focus and focal radius.
        stops: Gradient stops, or one color.
        spread: Spread method of a gradient.
        paint_matrix: From the gradient's units to those of the enclosing group.
    """

    glyph: int | None
    matrix: Matrix
    kind: str
    numbers: tuple[float, ...]
    stops: tuple[ColorStop, ...]
    spread: str
    paint_matrix: Matrix


@dataclass(frozen=True, slots=True)
class ColorGroup:
    """Layers over each other.

    Attributes:
        items: Bottom first.
        cut: Clipping glyph and its matrix; None if not clipped.
        blend: Blend mode of the whole.
        inside: Mask, by its alpha.
    """

    items: tuple["ColorFill | ColorGroup", ...]
    cut: tuple[int, Matrix] | None = None
    blend: str = "normal"
    inside: "ColorGroup | None" = None


class ColorTable:
    """The layers of a font's glyphs."""

    def __init__(self, tables: Any) -> None:
        self._tables = tables
        self._numbers: Mapping[str, int] = tables.getReverseGlyphMap()

    def layers(self, name: str) -> ColorGroup | None:
        """Returns the layers of a glyph; None if it has none.

        Raises:
            UnknownPaintError: A layer is not supported.
        """
        paint = self._paints.get(name)
        if paint is not None:
            return _PaintReader(self).group(paint)
        layers = self._flat_layers.get(name)
        if layers is None:
            return None
        fills = (
            ColorFill(
                self.number(layer.name), IDENTITY, "solid", (),
                (self.stop(0.0, layer.colorID, 1.0),), "pad", IDENTITY,
            )
            for layer in layers[:MAX_PAINTS]
        )  # fmt: skip
        return ColorGroup(tuple(fills))

    def paint_of(self, name: str) -> Any:
        """Returns the paint of another glyph. Raises UnknownPaintError if it has none."""
        if name not in self._paints:
            raise UnknownPaintError("a layer that is not there")
        return self._paints[name]

    def number(self, name: str) -> int:
        """Returns the index of a glyph."""
        return self._numbers[name]

    def stop(self, offset: float, index: int, alpha: float) -> ColorStop:
        """Makes a stop of a palette color."""
        if index == _TEXT_COLOR or index >= len(self._palette):
            return ColorStop(offset, None, alpha)
        return ColorStop(offset, self._palette[index], alpha)

    def layer_list(self, first: int, count: int) -> list[Any]:
        """Returns a slice of the layer list."""
        layers = self._table.LayerList
        return list(layers.Paint[first : first + count]) if layers else []

    @cached_property
    def _table(self) -> Any:
        return getattr(self._tables["COLR"], "table", None)

    @cached_property
    def _paints(self) -> Mapping[str, Any]:
        glyphs = getattr(self._table, "BaseGlyphList", None)
        records = glyphs.BaseGlyphPaintRecord if glyphs else ()
        return {record.BaseGlyph: record.Paint for record in records}

    @cached_property
    def _flat_layers(self) -> Mapping[str, Any]:
        colr = self._tables["COLR"]
        if self._table is None:
            return dict(colr.ColorLayers)
        return dict(colr._decompileColorLayersV0(self._table))

    @cached_property
    def _palette(self) -> list[Color]:
        palettes = self._tables["CPAL"].palettes if "CPAL" in self._tables else []
        return [
            (color.red / 255.0, color.green / 255.0, color.blue / 255.0, color.alpha / 255.0)
            for color in (palettes[0] if palettes else ())
        ]


class _PaintReader:
    """Reads the paints of one glyph."""

    def __init__(self, table: ColorTable) -> None:
        self._table = table
        self._paints_left = MAX_PAINTS
        self._depth = 0

    def group(self, paint: Any) -> ColorGroup:
        return ColorGroup(tuple(self._items(paint, IDENTITY)))

    def _items(self, paint: Any, matrix: Matrix) -> Iterator[ColorFill | ColorGroup]:
        """Yields the items of a paint; the matrix leads to the glyph's units."""
        self._paints_left -= 1
        if self._paints_left < 0 or self._depth >= MAX_DEPTH:
            raise UnknownPaintError("too many layers")
        self._depth += 1
        kind = _static_format(paint)
        if kind == 1:
            for each in self._table.layer_list(paint.FirstLayerIndex, paint.NumLayers):
                yield from self._items(each, matrix)
        elif kind == 10:
            yield from self._cut(paint, matrix)
        elif kind == 11:
            yield from self._items(self._table.paint_of(paint.Glyph), matrix)
        elif 12 <= kind < 32:
            yield from self._items(paint.Paint, compose(matrix, _transform(paint)))
        elif kind == 32:
            yield from self._composite(paint, matrix)
        else:
            yield self._fill(paint, None, IDENTITY, matrix)
        self._depth -= 1

    def _cut(self, paint: Any, matrix: Matrix) -> Iterator[ColorFill | ColorGroup]:
        """Yields a glyph filled with a paint."""
        glyph = self._table.number(paint.Glyph)
        inner, paint_matrix = paint.Paint, matrix
        for _ in range(MAX_DEPTH):
            if not 12 <= _static_format(inner) < 32:
                break
            paint_matrix = compose(paint_matrix, _transform(inner))
            inner = inner.Paint
        if 2 <= _static_format(inner) < 10:
            yield self._fill(inner, glyph, matrix, paint_matrix)
        else:
            yield ColorGroup(tuple(self._items(paint.Paint, matrix)), (glyph, matrix))

    def _composite(self, paint: Any, matrix: Matrix) -> Iterator[ColorGroup]:
        mode = int(paint.CompositeMode)
        source = ColorGroup(tuple(self._items(paint.SourcePaint, matrix)))
        backdrop = ColorGroup(tuple(self._items(paint.BackdropPaint, matrix)))
        if mode == _SOURCE:
            yield source
        elif mode == _BACKDROP:
            yield backdrop
        elif mode == _OVER:
            yield ColorGroup((backdrop, source))
        elif mode == _UNDER:
            yield ColorGroup((source, backdrop))
        elif mode == _SOURCE_IN:
            yield ColorGroup((source,), inside=backdrop)
        elif mode == _BACKDROP_IN:
            yield ColorGroup((backdrop,), inside=source)
        elif mode in _BLEND_MODES:
            yield ColorGroup((backdrop, ColorGroup((source,), blend=_BLEND_MODES[mode])))
        elif mode != _CLEAR:
            raise UnknownPaintError(f"composite mode {mode}")

    def _fill(
        self, paint: Any, glyph: int | None, matrix: Matrix, paint_matrix: Matrix
    ) -> ColorFill:
        kind = _static_format(paint)
        if kind == 2:
            stop = self._table.stop(0.0, paint.PaletteIndex, paint.Alpha)
            return ColorFill(glyph, matrix, "solid", (), (stop,), "pad", paint_matrix)
        if kind not in (4, 6):
            raise UnknownPaintError("sweep gradients" if kind == 8 else f"paint {paint.Format}")
        line = paint.ColorLine
        stops = sorted(
            (
                self._table.stop(float(each.StopOffset), each.PaletteIndex, each.Alpha)
                for each in line.ColorStop
            ),
            key=lambda stop: stop.offset,
        )
        if not stops:
            raise UnknownPaintError("gradients without colors")
        spread = _SPREADS[min(int(line.Extend), 2)]
        numbers = _linear_geometry(paint) if kind == 4 else _radial_geometry(paint)
        if numbers is None:
            return ColorFill(glyph, matrix, "solid", (), (stops[-1],), "pad", paint_matrix)
        first, last = stops[0].offset, stops[-1].offset
        if last > first:
            stops = [
                ColorStop((stop.offset - first) / (last - first), stop.color, stop.alpha)
                for stop in stops
            ]
            numbers = _trim_ends(numbers, first, last)
        if kind == 6:
            x0, y0, r0, x1, y1, r1 = numbers
            if r1 <= 0.0:
                # The end circle must have a radius.
                stops = [ColorStop(1.0 - s.offset, s.color, s.alpha) for s in reversed(stops)]
                x0, y0, r0, x1, y1, r1 = x1, y1, r1, x0, y0, r0
            if r1 <= 0.0:
                return ColorFill(glyph, matrix, "solid", (), (stops[0],), "pad", paint_matrix)
            numbers = (x1, y1, r1, x0, y0, max(r0, 0.0))
        name = "linear" if kind == 4 else "radial"
        return ColorFill(glyph, matrix, name, numbers, tuple(stops), spread, paint_matrix)


def _static_format(paint: Any) -> int:
    """Returns a paint's format; variable formats count as the static ones."""
    kind = int(paint.Format)
    if kind in (3, 5, 7, 9) or 12 < kind < 32:
        return kind - 1 if kind % 2 else kind
    return kind


def _transform(paint: Any) -> Matrix:
    kind = _static_format(paint)
    if kind == 12:
        t = paint.Transform
        return (t.xx, t.yx, t.xy, t.yy, t.dx, t.dy)
    if kind == 14:
        return translation(paint.dx, paint.dy)
    if kind in (16, 18):
        matrix = (paint.scaleX, 0.0, 0.0, paint.scaleY, 0.0, 0.0)
    elif kind in (20, 22):
        matrix = (paint.scale, 0.0, 0.0, paint.scale, 0.0, 0.0)
    elif kind in (24, 26):
        angle = math.radians(paint.angle)
        cos, sin = _native.cos(angle), _native.sin(angle)
        matrix = (cos, sin, -sin, cos, 0.0, 0.0)
    else:
        skews = (math.radians(-paint.xSkewAngle), math.radians(paint.ySkewAngle))
        matrix = (1.0, _native.tan(skews[1]), _native.tan(skews[0]), 1.0, 0.0, 0.0)
    if kind not in (18, 22, 26, 30):
        return matrix
    x, y = float(paint.centerX), float(paint.centerY)
    return compose(compose(translation(x, y), matrix), translation(-x, -y))


def _linear_geometry(paint: Any) -> tuple[float, ...] | None:
    """Returns the ends of a linear gradient; the third point of COLR rotates its color lines."""
    x0, y0, x1, y1 = float(paint.x0), float(paint.y0), float(paint.x1), float(paint.y1)
    x, y = paint.x2 - x0, paint.y2 - y0
    square = x * x + y * y
    across = (x1 - x0) * y - (y1 - y0) * x
    if square == 0.0 or across == 0.0:
        return None
    return x0, y0, x0 + across * y / square, y0 - across * x / square


def _radial_geometry(paint: Any) -> tuple[float, ...] | None:
    numbers = (paint.x0, paint.y0, paint.r0, paint.x1, paint.y1, paint.r1)
    return None if numbers[:3] == numbers[3:] else tuple(map(float, numbers))


def _trim_ends(numbers: tuple[float, ...], first: float, last: float) -> tuple[float, ...]:
    """Moves both ends to the first and the last stop."""
    half = len(numbers) // 2
    ends = tuple(zip(numbers[:half], numbers[half:], strict=True))
    return tuple(a + (b - a) * share for share in (first, last) for a, b in ends)
