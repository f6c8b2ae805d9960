# SPDX-License-Identifier: GPL-3.0-or-later

"""Gradients: what their attributes say, directly and by reference, as gradients of shapes."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ... import _native
from ..affine import IDENTITY, Matrix, determinant, multiplied
from ..shape import Shape
from .colors import Color
from .document import Document, SvgElement
from .lengths import Units, about_origin, read_length
from .styles import StyleSheets
from .values import Length, as_number, as_transform
from .warnings import Warnings

GRADIENTS = ("linearGradient", "radialGradient")
_COMMON = ("gradientUnits", "gradientTransform", "spreadMethod", "transform-origin")
_GEOMETRY = {
    "linearGradient": ("x1", "y1", "x2", "y2"),
    "radialGradient": ("cx", "cy", "r", "fx", "fy", "fr"),
}
_DEFAULTS = {
    "x1": Length(0.0),
    "y1": Length(0.0),
    "x2": Length(100.0, "%"),
    "y2": Length(0.0),
    "cx": Length(50.0, "%"),
    "cy": Length(50.0, "%"),
    "r": Length(50.0, "%"),
    "fr": Length(0.0),
}
# The share of a circle's radius that its focus has where that is the same circle.
_NEARLY = 1.0 - 1e-6
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


class PaintServers:
    """The gradients of a document."""

    def __init__(self, document: Document, sheets: StyleSheets, warnings: Warnings) -> None:
        self._document = document
        self._sheets = sheets
        self._warnings = warnings
        self._known: dict[SvgElement, tuple[dict[str, str], list[Stop]]] = {}

    def has_colors(self, element: SvgElement) -> bool:
        """Whether a gradient has stops, and a transform that leaves it an area."""
        attributes, stops = self._chain(element)
        own = as_transform(attributes.get("gradientTransform", ""))
        return bool(stops) and (own is None or determinant(own) != 0.0)

    def resolve(
        self,
        element: SvgElement,
        opacity: float,
        units: Units,
        bounds: tuple[float, float, float, float] | None,
        colors: Colors,
    ) -> Gradient | Color | None:
        """What a gradient paints.

        Args:
            element: The gradient.
            opacity: Of the paint, in [0, 1].
            units: Where it is used.
            bounds: Of the outline to paint: left, top, right, bottom.
            colors: How colors are kept.

        Returns:
            A single color where it comes to that; None where it cannot be used.
        """
        attributes, stops = self._chain(element)
        if not stops:
            return None
        stops = [Stop(stop.offset, (*stop.color[:3], stop.color[3] * opacity)) for stop in stops]
        if len(stops) == 1:
            return stops[0].color
        matrix = IDENTITY
        if attributes.get("gradientUnits") != "userSpaceOnUse":
            if bounds is None:
                return None
            left, top, right, bottom = bounds
            if right <= left or bottom <= top:
                return None
            matrix = (right - left, 0.0, 0.0, bottom - top, left, top)
            units = Units(1.0, 1.0, units.font_size)
        own = as_transform(attributes.get("gradientTransform", ""))
        if own is None:
            self._warnings.broken("gradientTransform", "ignored", element.line)
            own = IDENTITY
        own = about_origin(own, attributes.get("transform-origin", ""), units) or own
        matrix = multiplied(matrix, own)
        numbers = self._numbers(element, attributes, units)
        is_radial = element.tag == "radialGradient"
        if is_radial:
            if numbers[2] <= 0.0:
                return stops[-1].color
            numbers = _circles(numbers)
        elif numbers[:2] == numbers[2:]:
            return stops[-1].color
        spread = attributes.get("spreadMethod", "pad")
        if spread not in ("pad", "reflect", "repeat"):
            self._warnings.broken("spreadMethod", "ignored", element.line)
            spread = "pad"
        return Gradient(is_radial, numbers, list(pieces_between(stops, colors)), spread, matrix)

    def _chain(self, element: SvgElement) -> tuple[dict[str, str], list[Stop]]:
        """The attributes and stops of a gradient, and of those that it refers to."""
        if element not in self._known:
            attributes: dict[str, str] = {}
            stops: list[Stop] = []
            seen: set[SvgElement] = set()
            at: SvgElement | None = element
            while at is not None and at.tag in GRADIENTS:
                if at in seen:
                    self._warnings.broken(at.tag, "refers to itself", at.line)
                    break
                seen.add(at)
                names = _COMMON + (_GEOMETRY[at.tag] if at.tag == element.tag else ())
                declared = self._sheets.declared(at)
                for name in names:
                    if name in declared:
                        attributes.setdefault(name, declared[name])
                stops = stops or list(self._stops(at))
                at = self._document.ids.get(at.href)
            self._known[element] = attributes, stops
        return self._known[element]

    def _stops(self, gradient: SvgElement) -> Iterator[Stop]:
        offset = 0.0
        for child in gradient:
            if child.tag != "stop":
                continue
            assert isinstance(child, SvgElement)
            style = self._sheets.style(child)
            given = as_number(self._sheets.declared(child).get("offset", "0"))
            offset = max(offset, min(max(given or 0.0, 0.0), 1.0))
            color = style.color if isinstance(style.stop_color, str) else style.stop_color
            yield Stop(offset, (*color[:3], color[3] * style.stop_opacity))

    def _numbers(
        self,
        element: SvgElement,
        attributes: Mapping[str, str],
        units: Units,
    ) -> tuple[float, ...]:
        found: dict[str, float] = {}
        for name in _GEOMETRY[element.tag]:
            length = read_length(element, attributes, name, self._warnings) or _DEFAULTS.get(name)
            # A focus is in the center, where nothing is said of it.
            found[name] = found["c" + name[1]] if length is None else units.pixels(length, name)
        return tuple(found.values())


def _circles(numbers: tuple[float, ...]) -> tuple[float, ...]:
    """Center, radius, focus and its radius, where both circles are not the same one."""
    cx, cy, r, fx, fy, fr = numbers
    fr = max(fr, 0.0)
    return cx, cy, r, fx, fy, (r * _NEARLY if (cx, cy, r) == (fx, fy, fr) else fr)


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
