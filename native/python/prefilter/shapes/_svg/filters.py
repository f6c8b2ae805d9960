# SPDX-License-Identifier: GPL-3.0-or-later

"""Filters: what becomes of a group's pixels, step by step, as the file says it."""

from dataclasses import dataclass

import numpy as np

from .blending import BLEND_MODES
from .bounding import object_bounds
from .context import Context, Sources
from .document import SvgElement
from .lengths import Units
from .masks import box_in_units, shares_of
from .tree import Box, Filter, Step, carried
from .values import IDENTITY, Length, Matrix, as_color, as_number, leading_numbers, multiplied

# Products of larger numbers would leave the range of floats.
_LARGEST = 1e9
_NOTHING = (0.0, 0.0, 0.0, 0.0)
_DEFAULTS = {"x": -10.0, "y": -10.0, "width": 120.0, "height": 120.0}
_OPERATORS = ("over", "in", "out", "atop", "xor", "lighter", "arithmetic")
_CHANNELS = ("feFuncR", "feFuncG", "feFuncB", "feFuncA")
# Of red, green and blue, as Filter Effects has them.
_RED, _GREEN, _BLUE = 0.213, 0.715, 0.072
_SATURATION = np.array([[_RED, _GREEN, _BLUE]] * 3)


class UnknownStepError(Exception):
    """A filter needs something that is not supported; the message names it."""


@dataclass(frozen=True)
class _Place:
    """Where a filter is applied.

    Attributes:
        units: From those of the steps' lengths to the element's: shares of a box, or its own.
        matrix: From the element's to those of the tree.
        region: Of the filter, in the element's units.
    """

    units: Matrix
    matrix: Matrix
    region: Box


def filter_of(element: SvgElement, context: Context, sources: Sources) -> Filter | None:
    """The filter of an element, if it has one that can be applied.

    `context` is that within the element.
    """
    text = sources.sheets.declared(element).get("filter", "none")
    if text.lower() == "none":
        return None
    found = sources.referred(text)
    if found is None and not text.lower().startswith("url("):
        sources.warnings.unsupported("filter", f"ignored: {text[:40]}", element.line)
        return None
    if found is None or found.tag != "filter":
        sources.warnings.broken("filter", "ignored", element.line)
        return None
    box = object_bounds(element, context, sources)
    region, matrix = box_in_units(found, "filterUnits", _DEFAULTS, box, context, sources)
    if region is None:
        return Filter((), _NOTHING, context.colors.is_linear)
    units = shares_of(box) if found.get("primitiveUnits") == "objectBoundingBox" else IDENTITY
    place = _Place(units or IDENTITY, context.matrix, carried(region, matrix))
    try:
        steps = tuple(
            _step(child, place, context, sources)
            for child in found
            if isinstance(child, SvgElement) and child.tag.startswith("fe")
        )
    except UnknownStepError as error:
        sources.warnings.unsupported(f"filter with {error}", "ignored", element.line)
        return None
    return Filter(steps, carried(place.region, context.matrix), context.colors.is_linear)


def _step(element: SvgElement, place: _Place, context: Context, sources: Sources) -> Step:
    kind = _KINDS.get(element.tag)
    if kind is None:
        raise UnknownStepError(f"<{element.tag}>")
    inputs, numbers, name = kind(element, place, sources)
    for each in inputs:
        if each in ("BackgroundImage", "BackgroundAlpha", "FillPaint", "StrokePaint"):
            raise UnknownStepError(each)
    style = sources.sheets.style(element)
    return Step(
        element.tag,
        tuple(inputs),
        element.get("result", ""),
        tuple(min(max(number, -_LARGEST), _LARGEST) for number in numbers),
        name,
        style.color_interpolation_filters != "srgb",
        _subregion(element, place, context, sources),
    )


def _subregion(
    element: SvgElement, place: _Place, context: Context, sources: Sources
) -> Box | None:
    """Where the result of a step ends, in the tree's units; None for that of the filter."""
    declared = sources.sheets.declared(element)
    if not any(name in declared for name in _DEFAULTS):
        return None
    left, top, right, bottom = place.region
    sides = {"x": left, "y": top, "width": right - left, "height": bottom - top}
    units = context.units
    if place.units != IDENTITY:
        units = Units(1.0, 1.0, units.font_size)
    a, _, _, d, e, f = place.units
    for name in sides:
        if name in declared:
            value = sources.pixels(element, name, Length(0.0), units)
            scale, shift = (a, e) if name in ("x", "width") else (d, f)
            sides[name] = value * scale + (shift if len(name) == 1 else 0.0)
    x, y, width, height = sides.values()
    return carried((x, y, x + max(width, 0.0), y + max(height, 0.0)), place.matrix)


_Found = tuple[list[str], list[float], str]


def _numbers(text: str | None, default: list[float]) -> list[float]:
    found, is_whole = leading_numbers(text or "")
    return found if found and is_whole else default


def _number(element: SvgElement, name: str, default: float) -> float:
    found = as_number(element.get(name, ""))
    return default if found is None else found


def _in(element: SvgElement, name: str = "in") -> str:
    return element.get(name, "").strip()


def _blur(element: SvgElement, place: _Place, _: Sources) -> _Found:
    return [_in(element)], _deviations(element, 0.0, place), ""


def _deviations(element: SvgElement, default: float, place: _Place) -> list[float]:
    numbers = _numbers(element.get("stdDeviation"), [default])
    if len(numbers) > 2 or min(numbers) < 0.0:
        numbers = [0.0]
    return _scales(numbers[0], numbers[-1], place)


def _scales(x: float, y: float, place: _Place) -> list[float]:
    """Lengths along x and y as lengths of the tree, along its x and y."""
    a, b, c, d = multiplied(place.matrix, place.units)[:4]
    width, height = (abs(a) + abs(b), abs(c) + abs(d))
    if min(abs(a), abs(b)) > 1e-9 * width:
        # What is turned is as wide as the map's axes are long.
        width, height = (a * a + b * b) ** 0.5, (c * c + d * d) ** 0.5
    elif abs(b) > abs(a):
        return [y * height, x * width]
    return [x * width, y * height]


def _offset(element: SvgElement, place: _Place, _: Sources) -> _Found:
    x, y = _number(element, "dx", 0.0), _number(element, "dy", 0.0)
    return [_in(element)], _moved(x, y, place), ""


def _moved(x: float, y: float, place: _Place) -> list[float]:
    a, b, c, d = multiplied(place.matrix, place.units)[:4]
    return [a * x + c * y, b * x + d * y]


def _flood(element: SvgElement, place: _Place, sources: Sources) -> _Found:
    declared = sources.sheets.declared(element)
    color = as_color(declared.get("flood-color", "black"))
    if color is None or isinstance(color, str):
        color = sources.sheets.style(element).color if color else (0.0, 0.0, 0.0, 1.0)
    opacity = as_number(declared.get("flood-opacity", "1"))
    alpha = color[3] * (1.0 if opacity is None else min(max(opacity, 0.0), 1.0))
    return [], [*color[:3], alpha], ""


def _shadow(element: SvgElement, place: _Place, sources: Sources) -> _Found:
    _, color, _ = _flood(element, place, sources)
    move = _moved(_number(element, "dx", 2.0), _number(element, "dy", 2.0), place)
    return [_in(element)], [*_deviations(element, 2.0, place), *move, *color], ""


def _merge(element: SvgElement, _: _Place, sources: Sources) -> _Found:
    del sources
    nodes = [node for node in element if node.tag == "feMergeNode"]
    return [_in(node) for node in nodes if isinstance(node, SvgElement)], [], ""


def _composite(element: SvgElement, _: _Place, sources: Sources) -> _Found:
    del sources
    name = element.get("operator", "over").strip()
    factors = [_number(element, f"k{k}", 0.0) for k in range(1, 5)]
    inputs = [_in(element), _in(element, "in2")]
    return inputs, factors, name if name in _OPERATORS else "over"


def _blend(element: SvgElement, _: _Place, sources: Sources) -> _Found:
    del sources
    name = element.get("mode", "normal").strip()
    return [_in(element), _in(element, "in2")], [], name if name in BLEND_MODES else "normal"


def _color_matrix(element: SvgElement, _: _Place, sources: Sources) -> _Found:
    del sources
    from ... import _native

    kind = element.get("type", "matrix").strip()
    matrix = np.eye(4, 5)
    if kind == "luminanceToAlpha":
        matrix = np.zeros((4, 5))
        matrix[3, :3] = _RED, _GREEN, _BLUE
    elif kind == "saturate":
        share = max(_numbers(element.get("values"), [1.0])[0], 0.0)
        matrix[:3, :3] = _SATURATION + share * (np.eye(3) - _SATURATION)
    elif kind == "hueRotate":
        angle = _numbers(element.get("values"), [0.0])[0] * (np.pi / 180.0)
        cos, sin = _native.cos(angle), _native.sin(angle)
        turn = np.array([[-0.213, -0.715, 0.928], [0.143, 0.140, -0.283], [-0.787, 0.715, 0.072]])
        matrix[:3, :3] = _SATURATION + cos * (np.eye(3) - _SATURATION) + sin * turn
    else:
        values = _numbers(element.get("values"), [])
        if len(values) == 20:
            matrix = np.array(values).reshape(4, 5)
    return [_in(element)], matrix.ravel().tolist(), ""


def _transfer(element: SvgElement, _: _Place, sources: Sources) -> _Found:
    """For each channel: how many numbers, and the values at equal distances, or a step each."""
    del sources
    numbers: list[float] = []
    for name in _CHANNELS:
        functions = [child for child in element if child.tag == name]
        function = functions[-1] if functions else None
        kind = function.get("type", "identity").strip() if function is not None else "identity"
        if kind == "gamma":
            raise UnknownStepError("type 'gamma' of <feComponentTransfer>")
        values = [0.0, 1.0]
        if isinstance(function, SvgElement) and kind == "linear":
            start = _number(function, "intercept", 0.0)
            values = [start, start + _number(function, "slope", 1.0)]
        elif function is not None and kind in ("table", "discrete"):
            values = _numbers(function.get("tableValues"), values)
        is_discrete = (
            kind == "discrete" and function is not None and "tableValues" in function.attrib
        )
        numbers += [-len(values) if is_discrete else len(values), *values]
    return [_in(element)], numbers, ""


_KINDS = {
    "feGaussianBlur": _blur,
    "feOffset": _offset,
    "feFlood": _flood,
    "feDropShadow": _shadow,
    "feMerge": _merge,
    "feComposite": _composite,
    "feBlend": _blend,
    "feColorMatrix": _color_matrix,
    "feComponentTransfer": _transfer,
}
