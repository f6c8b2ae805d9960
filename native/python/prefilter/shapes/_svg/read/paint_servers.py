# SPDX-License-Identifier: GPL-3.0-or-later

"""Gradient elements, with attributes inherited by reference."""

from collections.abc import Iterator, Mapping

from ...affine import IDENTITY, compose, determinant
from ..model.colors import Color
from ..model.gradients import Colors, Gradient, Stop, sample_stops
from ..model.values import Length, parse_number, parse_transform
from ..model.warnings import Warnings
from .document import GRADIENTS, Document, SvgElement
from .lengths import Units, read_length, transform_about_origin
from .styles import StyleSheets

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
# Radius of the focal circle, relative to the end circle, if both circles are the same.
_COINCIDENT_FOCUS_RADIUS = 1.0 - 1e-6


class PaintServers:
    """The gradients of a document."""

    def __init__(self, document: Document, sheets: StyleSheets, warnings: Warnings) -> None:
        self._document = document
        self._sheets = sheets
        self._warnings = warnings
        self._known: dict[SvgElement, tuple[dict[str, str], list[Stop]]] = {}

    def has_colors(self, element: SvgElement) -> bool:
        """Returns whether a gradient has stops and a regular transform."""
        attributes, stops = self._chain(element)
        own = parse_transform(attributes.get("gradientTransform", ""))
        return bool(stops) and (own is None or determinant(own) != 0.0)

    def resolve(
        self,
        element: SvgElement,
        opacity: float,
        units: Units,
        bounds: tuple[float, float, float, float] | None,
        colors: Colors,
    ) -> Gradient | Color | None:
        """Evaluates a gradient for an outline.

        Args:
            opacity: Opacity of the paint, in [0, 1].
            units: Units of the outline's element.
            bounds: Bounding box of the outline: left, top, right, bottom.

        Returns:
            The gradient; a color if it is uniform; None if it cannot be used.
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
        own = parse_transform(attributes.get("gradientTransform", ""))
        if own is None:
            self._warnings.broken("gradientTransform", "ignored", element.line)
            own = IDENTITY
        own = transform_about_origin(own, attributes.get("transform-origin", ""), units) or own
        matrix = compose(matrix, own)
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
        return Gradient(is_radial, numbers, list(sample_stops(stops, colors)), spread, matrix)

    def _chain(self, element: SvgElement) -> tuple[dict[str, str], list[Stop]]:
        """Collects attributes and stops along the chain of references."""
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
            offset_value = parse_number(self._sheets.declared(child).get("offset", "0"))
            offset = max(offset, min(max(offset_value or 0.0, 0.0), 1.0))
            color = style.color if isinstance(style.stop_color, str) else style.stop_color
            yield Stop(offset, (*color[:3], color[3] * style.stop_opacity))

    def _numbers(
        self,
        element: SvgElement,
        attributes: Mapping[str, str],
        units: Units,
    ) -> tuple[float, ...]:
        pixels: dict[str, float] = {}
        for name in _GEOMETRY[element.tag]:
            length = read_length(element, attributes, name, self._warnings) or _DEFAULTS.get(name)
            # The focus defaults to the center.
            pixels[name] = pixels["c" + name[1]] if length is None else units.pixels(length, name)
        return tuple(pixels.values())


def _circles(numbers: tuple[float, ...]) -> tuple[float, ...]:
    """Returns the numbers of a radial gradient; shrinks a focal circle equal to the end circle."""
    cx, cy, r, fx, fy, fr = numbers
    fr = max(fr, 0.0)
    return cx, cy, r, fx, fy, (r * _COINCIDENT_FOCUS_RADIUS if (cx, cy, r) == (fx, fy, fr) else fr)
