# SPDX-License-Identifier: GPL-3.0-or-later

"""Parsers of attributes and properties: numbers, lengths, colors, paints, transforms."""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, wraps
from typing import Any, TypeVar

import tinycss2

from .... import _native
from ...affine import IDENTITY, Matrix, compose, translation
from .calculations import DEGREES, Quantity, evaluate_quantity, is_calculation
from .colors import Color, color_from_token

BLACK: Color = (0.0, 0.0, 0.0, 1.0)

Result = TypeVar("Result")
_MAX_REMEMBERED = 1 << 10
"""Characters. Longer texts are not cached, as the cache would hold their memory."""
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_LENGTH = re.compile(rf"\s*({_NUMBER})([a-zA-Z]*|%)\s*", re.ASCII)
# CSS pixels per unit; em and ex are multiples of the font size.
_UNITS = {
    "": 1.0,
    "px": 1.0,
    "in": 96.0,
    "cm": 96.0 / 2.54,
    "mm": 96.0 / 25.4,
    "q": 24.0 / 25.4,
    "pt": 96.0 / 72.0,
    "pc": 16.0,
}
_PIXELS = {unit: ("px", factor) for unit, factor in _UNITS.items() if unit}
_FONT_UNITS = {"em": 1.0, "ex": 0.5}
_OTHER_UNITS = frozenset(
    ["ch", "rem", "cap", "ic", "lh", "rlh", "vw", "vh", "vi", "vb", "vmin", "vmax"]
)


@dataclass(frozen=True, slots=True)
class Length:
    """A number with its unit; "%" and font units need a reference to become pixels.

    Attributes:
        more: Terms to add, from calc().
    """

    value: float
    unit: str = ""
    more: tuple["Length", ...] = ()

    def pixels(self, whole: float, font_size: float) -> float:
        """Converts to pixels; `whole` is 100 %."""
        if self.more:
            parts = (Length(self.value, self.unit), *self.more)
            return sum(part.pixels(whole, font_size) for part in parts)
        if self.unit == "%":
            return self.value * whole / 100.0
        if self.unit in _FONT_UNITS:
            return self.value * _FONT_UNITS[self.unit] * font_size
        return self.value * _UNITS[self.unit]


class UnknownUnitError(ValueError):
    """A length in a CSS unit that is not supported."""


def parse_length(text: str) -> Length | None:
    """Parses a length; returns None if invalid. Raises UnknownUnitError."""
    match = _LENGTH.fullmatch(text)
    if not match:
        return _parse_calculated_length(text) if "(" in text else None
    return _make_length(float(match[1]), match[2].lower())


def _make_length(value: float, unit: str) -> Length | None:
    if not math.isfinite(value):
        return None
    if unit == "%" or unit in _UNITS or unit in _FONT_UNITS:
        return Length(value, unit)
    if unit in _OTHER_UNITS:
        raise UnknownUnitError(unit)
    return None


def _parse_calculated_length(text: str) -> Length | None:
    tokens = _tokenize(text)
    if len(tokens) != 1 or not is_calculation(tokens[0]):
        return None
    return _length_from_quantity(evaluate_quantity(tokens[0], _PIXELS))


def _length_from_quantity(quantity: Quantity | None) -> Length | None:
    if quantity is None:
        return None
    parts = [_make_length(value, unit) for unit, value in quantity.items()]
    lengths = [part for part in parts if part is not None]
    if len(lengths) < len(parts):
        return None
    first = lengths[0] if lengths else Length(0.0)
    return replace(first, more=tuple(lengths[1:])) if lengths[1:] else first


def parse_lengths(text: str) -> tuple[Length, ...] | None:
    if "(" in text:
        tokens = [token for token in _tokenize(text) if token != ","]
        lengths = [_length_from_quantity(evaluate_quantity(token, _PIXELS)) for token in tokens]
        return None if None in lengths else tuple(each for each in lengths if each is not None)
    lengths = [parse_length(part) for part in re.split(r"\s*,\s*|\s+", text.strip())]
    return tuple(each for each in lengths if each is not None) if None not in lengths else None


_ORIGINS = {"left": 0.0, "top": 0.0, "center": 50.0, "right": 100.0, "bottom": 100.0}


def parse_origin(text: str) -> tuple[Length, Length] | None:
    """Parses `transform-origin` into two lengths; returns None if invalid."""
    names = _split_words(text.lower())
    if not names:
        return Length(0.0), Length(0.0)
    if len(names) > 1 and (names[0] in ("top", "bottom") or names[1] in ("left", "right")):
        names[:2] = names[1], names[0]
    elif len(names) == 1 and names[0] in ("top", "bottom"):
        names.insert(0, "center")
    try:
        lengths = [
            Length(_ORIGINS[name], "%") if name in _ORIGINS else parse_length(name)
            for name in names
        ]
    except UnknownUnitError:
        return None
    x, y = lengths[0], lengths[1] if len(lengths) > 1 else Length(50.0, "%")
    # The third length is a depth.
    return (x, y) if x is not None and y is not None and len(lengths) < 4 else None


def _split_words(text: str) -> list[str]:
    """Splits at whitespace outside parentheses."""
    if "(" not in text:
        return text.split()
    return [tinycss2.serialize([token]) for token in _tokenize(text)]


def parse_number(text: str) -> float | None:
    """Parses a number, or a percentage as a fraction."""
    match = _LENGTH.fullmatch(text)
    if not match and "(" in text:
        tokens = _tokenize(text)
        quantity = evaluate_quantity(tokens[0], {}) if len(tokens) == 1 else None
        if quantity is None or quantity.keys() - {"", "%"}:
            return None
        return quantity.get("", 0.0) + 0.01 * quantity.get("%", 0.0)
    if not match or match[2] not in ("", "%"):
        return None
    value = float(match[1]) * (0.01 if match[2] else 1.0)
    return value if math.isfinite(value) else None


def cache_short_texts(read: Callable[..., Result]) -> Callable[..., Result]:
    """Caches the results of a parser for short texts."""
    cached = lru_cache(maxsize=4096)(read)

    @wraps(read)
    def call(*texts: Any) -> Result:
        is_long = any(isinstance(text, str) and len(text) > _MAX_REMEMBERED for text in texts)
        return (read if is_long else cached)(*texts)

    return call


def leading_numbers(text: str) -> tuple[list[float], bool]:
    """Parses numbers up to the first error; returns them, and whether there was no error."""
    return _native.read_numbers(text.encode(errors="replace"))


@dataclass(frozen=True, slots=True)
class Paint:
    """The value of `fill` or `stroke`.

    Attributes:
        color: None paints nothing; "current" is the property `color`; "context-fill" and
            "context-stroke" are the paints of the referring `use` or marked outline.
        server: The address in url(), usually # and the id of a gradient. Then `color` is the
            fallback.
    """

    color: Color | str | None
    server: str = ""


@cache_short_texts
def parse_color(text: str) -> Color | str | None:
    """Parses a color; returns "current" for currentcolor and None if invalid."""
    try:
        return color_from_token(tinycss2.parse_one_component_value(text, skip_comments=True))
    except ValueError:
        return None


def parse_background(text: str) -> Color | str | None:
    """Finds the color in a value of the property `background`; see `parse_color`."""
    colors = [color_from_token(token) for token in _tokenize(text)]
    return next((color for color in colors if color is not None), None)


@cache_short_texts
def parse_paint(text: str) -> Paint | None:
    tokens = _tokenize(text)
    if not tokens:
        return None
    server = parse_url(tokens[0])
    if server is None:
        return _parse_plain_paint(tokens)
    fallback = _parse_plain_paint(tokens[1:]) if tokens[1:] else Paint(None)
    return Paint(fallback.color, server) if fallback else None


def _parse_plain_paint(tokens: Sequence[Any]) -> Paint | None:
    if len(tokens) != 1:
        return None
    if tokens[0].type == "ident" and tokens[0].lower_value == "none":
        return Paint(None)
    if tokens[0].type == "ident" and tokens[0].lower_value in ("context-fill", "context-stroke"):
        return Paint(tokens[0].lower_value)
    color = color_from_token(tokens[0])
    return Paint(color) if color is not None else None


def parse_url(token: Any) -> str | None:
    """Returns the address of a `url()`; None for other tokens."""
    if token.type == "url":
        url = token.value
    elif token.type == "function" and token.lower_name == "url":
        url = "".join(each.value for each in token.arguments if each.type == "string")
    else:
        return None
    return str(url).strip()


def _tokenize(text: str) -> list[Any]:
    tokens = tinycss2.parse_component_value_list(text, skip_comments=True)
    return [token for token in tokens if token.type != "whitespace"]


@cache_short_texts
def parse_transform(text: str, *whole: float) -> Matrix | None:
    """Parses a list of transforms and multiplies them; returns None if one is invalid.

    Args:
        whole: Width and height that are 100 %, and the font size; without them, lengths must be
            numbers or pixels.
    """
    if text.strip().lower() in ("", "none"):
        return IDENTITY
    matrix = IDENTITY
    for name, arguments in _functions(text, whole or (0.0, 0.0, 0.0)):
        transform = _make_transform(name, arguments)
        if transform is None:
            return None
        matrix = compose(matrix, transform)
    return matrix if all(map(math.isfinite, matrix)) else None


def has_relative_lengths(text: str) -> bool:
    """Returns whether a list of transforms has percentages or font units."""
    return "%" in text or "em" in text or "ex" in text


def _functions(text: str, whole: tuple[float, ...]) -> Iterator[tuple[str, list[float] | None]]:
    name = ""
    for token in _tokenize(text):
        if token.type == "ident" and not name:
            name = token.lower_value  # Whitespace precedes its parenthesis.
        elif token.type == "() block" and name:
            yield name, _arguments(name, token.content, whole)
            name = ""
        elif token.type == "function" and not name:
            yield token.lower_name, _arguments(token.lower_name, token.arguments, whole)
        elif token != "," or name:
            yield "", None
    if name:
        yield "", None


_IN_TRANSFORMS = _PIXELS | {unit: ("deg", factor) for unit, factor in DEGREES.items()}


def _arguments(name: str, tokens: Sequence[Any], whole: tuple[float, ...]) -> list[float] | None:
    """Reads numbers, pixels, and angles in degrees."""
    numbers: list[float] = []
    for token in tokens:
        if token.type in ("whitespace", "comment") or token == ",":
            continue
        quantity = evaluate_quantity(token, _IN_TRANSFORMS)
        if quantity is None or quantity.keys() - {"", "px", "deg", "%", "em", "ex"}:
            return None
        total = 0.0
        along = whole[1] if name == "translatey" or len(numbers) == 1 else whole[0]
        for unit, value in quantity.items():
            if unit == "%":
                value *= 0.01 * (1.0 if name.startswith("scale") else along)
            total += value * _FONT_UNITS[unit] * whole[2] if unit in _FONT_UNITS else value
        numbers.append(total)
    return numbers if all(map(math.isfinite, numbers)) else None


def _make_transform(name: str, numbers: list[float] | None) -> Matrix | None:
    match name, numbers:
        case "matrix", [a, b, c, d, e, f]:
            return (a, b, c, d, e, f)
        case "translate", [x]:
            return translation(x, 0.0)
        case "translate", [x, y]:
            return translation(x, y)
        case "translatex", [x]:
            return translation(x, 0.0)
        case "translatey", [y]:
            return translation(0.0, y)
        case "scale", [s]:
            return (s, 0.0, 0.0, s, 0.0, 0.0)
        case "scale", [x, y]:
            return (x, 0.0, 0.0, y, 0.0, 0.0)
        case "scalex", [x]:
            return (x, 0.0, 0.0, 1.0, 0.0, 0.0)
        case "scaley", [y]:
            return (1.0, 0.0, 0.0, y, 0.0, 0.0)
        case "rotate", [angle]:
            return rotation(angle)
        case "rotate", [angle, x, y]:
            there, back = translation(x, y), translation(-x, -y)
            return compose(compose(there, rotation(angle)), back)
        case "skewx", [angle]:
            return (1.0, 0.0, _native.tan(math.radians(angle)), 1.0, 0.0, 0.0)
        case "skewy", [angle]:
            return (1.0, _native.tan(math.radians(angle)), 0.0, 1.0, 0.0, 0.0)
    return None


def parse_rotate(text: str) -> Matrix | None:
    """Parses the property `rotate`: an angle, with an axis before or after it."""
    axis: list[str] = []
    angle: float | None = None
    numbers: list[float] = []
    for token in _tokenize(text):
        quantity = evaluate_quantity(token, _IN_TRANSFORMS)
        if token.type == "ident":
            axis.append(token.lower_value)
        elif quantity is not None and quantity.keys() == {"deg"} and angle is None:
            angle = quantity["deg"]
        elif quantity is not None and quantity.keys() == {""}:
            numbers.append(quantity[""])
        else:
            return None
    # Other axes would rotate out of the plane.
    is_flat = axis in ([], ["z"]) if not numbers else not axis and len(numbers) == 3
    if angle is None or not is_flat or (numbers and (numbers[:2] != [0.0, 0.0] or not numbers[2])):
        return None
    return rotation(-angle if numbers and numbers[2] < 0.0 else angle)


def as_path(text: str) -> str | None:
    """Returns the path data in a value of the property `d`; None if invalid."""
    tokens = _tokenize(text)
    if len(tokens) != 1:
        return None
    token = tokens[0]
    if token.type == "ident" and token.lower_value == "none":
        return ""
    if token.type != "function" or token.lower_name != "path":
        return None
    inside = [each for each in token.arguments if each.type not in ("whitespace", "comment")]
    return str(inside[0].value) if len(inside) == 1 and inside[0].type == "string" else None


def rotation(angle: float) -> Matrix:
    """Returns a rotation by degrees."""
    # Quarter turns are exact, so that upright edges stay upright.
    quarters, remainder = divmod(angle, 90.0)
    cos, sin = _native.cos(math.radians(angle)), _native.sin(math.radians(angle))
    if remainder == 0.0:
        cos, sin = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    return (cos, sin, -sin, cos, 0.0, 0.0)
