# SPDX-License-Identifier: GPL-3.0-or-later

"""What attributes and properties hold: numbers, lengths, colors, paints, transforms."""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, wraps
from typing import Any, TypeVar

import tinycss2

from .... import _native
from ...affine import IDENTITY, Matrix, multiplied
from .calculations import DEGREES, Quantity, is_calculation, quantity_of
from .colors import Color, color_of

BLACK: Color = (0.0, 0.0, 0.0, 1.0)

Found = TypeVar("Found")
_MOST_REMEMBERED = 1 << 10
"""Characters: what long texts come to would be kept for good."""
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_LENGTH = re.compile(rf"\s*({_NUMBER})([a-zA-Z]*|%)\s*", re.ASCII)
# CSS pixels; em and ex are multiples of the font's size.
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
    """A number with its unit; "%" and the units of fonts need to know what they are relative to.

    Attributes:
        more: What is added to it, as calc() has it.
    """

    value: float
    unit: str = ""
    more: tuple["Length", ...] = ()

    def pixels(self, whole: float, font_size: float) -> float:
        """In pixels; `whole` is 100 %."""
        if self.more:
            parts = (Length(self.value, self.unit), *self.more)
            return sum(part.pixels(whole, font_size) for part in parts)
        if self.unit == "%":
            return self.value * whole / 100.0
        if self.unit in _FONT_UNITS:
            return self.value * _FONT_UNITS[self.unit] * font_size
        return self.value * _UNITS[self.unit]


class UnknownUnitError(ValueError):
    """A length in a unit that CSS has, and that is not supported here."""


def as_length(text: str) -> Length | None:
    """The length that a text is; None where it is none. Raises UnknownUnitError."""
    match = _LENGTH.fullmatch(text)
    if not match:
        return _calculated_length(text) if "(" in text else None
    return _length_of(float(match[1]), match[2].lower())


def _length_of(value: float, unit: str) -> Length | None:
    if not math.isfinite(value):
        return None
    if unit == "%" or unit in _UNITS or unit in _FONT_UNITS:
        return Length(value, unit)
    if unit in _OTHER_UNITS:
        raise UnknownUnitError(unit)
    return None


def _calculated_length(text: str) -> Length | None:
    tokens = _tokens(text)
    if len(tokens) != 1 or not is_calculation(tokens[0]):
        return None
    return _length_of_sum(quantity_of(tokens[0], _PIXELS))


def _length_of_sum(found: Quantity | None) -> Length | None:
    if found is None:
        return None
    parts = [_length_of(value, unit) for unit, value in found.items()]
    lengths = [part for part in parts if part is not None]
    if len(lengths) < len(parts):
        return None
    first = lengths[0] if lengths else Length(0.0)
    return replace(first, more=tuple(lengths[1:])) if lengths[1:] else first


def as_lengths(text: str) -> tuple[Length, ...] | None:
    if "(" in text:
        tokens = [token for token in _tokens(text) if token != ","]
        lengths = [_length_of_sum(quantity_of(token, _PIXELS)) for token in tokens]
        return None if None in lengths else tuple(each for each in lengths if each is not None)
    found = [as_length(part) for part in re.split(r"\s*,\s*|\s+", text.strip())]
    return tuple(each for each in found if each is not None) if None not in found else None


_ORIGINS = {"left": 0.0, "top": 0.0, "center": 50.0, "right": 100.0, "bottom": 100.0}


def as_origin(text: str) -> tuple[Length, Length] | None:
    """The two lengths that the property `transform-origin` holds; None for what is none."""
    names = _words(text.lower())
    if not names:
        return Length(0.0), Length(0.0)
    if len(names) > 1 and (names[0] in ("top", "bottom") or names[1] in ("left", "right")):
        names[:2] = names[1], names[0]
    elif len(names) == 1 and names[0] in ("top", "bottom"):
        names.insert(0, "center")
    try:
        found = [
            Length(_ORIGINS[name], "%") if name in _ORIGINS else as_length(name) for name in names
        ]
    except UnknownUnitError:
        return None
    x, y = found[0], found[1] if len(found) > 1 else Length(50.0, "%")
    # A third one is a depth.
    return (x, y) if x is not None and y is not None and len(found) < 4 else None


def _words(text: str) -> list[str]:
    """What blanks are between, but for those in calculations."""
    if "(" not in text:
        return text.split()
    return [tinycss2.serialize([token]) for token in _tokens(text)]


def as_number(text: str) -> float | None:
    """A number, or a percentage as its hundredth."""
    match = _LENGTH.fullmatch(text)
    if not match and "(" in text:
        tokens = _tokens(text)
        found = quantity_of(tokens[0], {}) if len(tokens) == 1 else None
        if found is None or found.keys() - {"", "%"}:
            return None
        return found.get("", 0.0) + 0.01 * found.get("%", 0.0)
    if not match or match[2] not in ("", "%"):
        return None
    value = float(match[1]) * (0.01 if match[2] else 1.0)
    return value if math.isfinite(value) else None


def remembered(read: Callable[..., Found]) -> Callable[..., Found]:
    """Has a function of texts remember what the last short ones came to."""
    cached = lru_cache(maxsize=4096)(read)

    @wraps(read)
    def found(*texts: Any) -> Found:
        is_long = any(isinstance(text, str) and len(text) > _MOST_REMEMBERED for text in texts)
        return (read if is_long else cached)(*texts)

    return found


def leading_numbers(text: str) -> tuple[list[float], bool]:
    """The numbers that a text begins with, and whether it holds nothing else."""
    return _native.read_numbers(text.encode(errors="replace"))


@dataclass(frozen=True, slots=True)
class Paint:
    """What an outline is filled or stroked with.

    Attributes:
        color: None paints nothing; "current" stands for the property `color`; "context-fill" and
            "context-stroke" for what a `use` or the outline of a marker has.
        server: What url() refers to: # and the id of a gradient, usually. The color is for where
            there is none.
    """

    color: Color | str | None
    server: str = ""


@remembered
def as_color(text: str) -> Color | str | None:
    """A color, or "current"; None for what is none."""
    try:
        return color_of(tinycss2.parse_one_component_value(text, skip_comments=True))
    except ValueError:
        return None


def as_background(text: str) -> Color | str | None:
    """The color among the values of the property `background`, as of `as_color`."""
    colors = [color_of(token) for token in _tokens(text)]
    return next((color for color in colors if color is not None), None)


@remembered
def as_paint(text: str) -> Paint | None:
    tokens = _tokens(text)
    if not tokens:
        return None
    server = url_of(tokens[0])
    if server is None:
        return _plain_paint(tokens)
    fallback = _plain_paint(tokens[1:]) if tokens[1:] else Paint(None)
    return Paint(fallback.color, server) if fallback else None


def _plain_paint(tokens: Sequence[Any]) -> Paint | None:
    if len(tokens) != 1:
        return None
    if tokens[0].type == "ident" and tokens[0].lower_value == "none":
        return Paint(None)
    if tokens[0].type == "ident" and tokens[0].lower_value in ("context-fill", "context-stroke"):
        return Paint(tokens[0].lower_value)
    color = color_of(tokens[0])
    return Paint(color) if color is not None else None


def url_of(token: Any) -> str | None:
    """The address in a `url()`; None for other tokens."""
    if token.type == "url":
        url = token.value
    elif token.type == "function" and token.lower_name == "url":
        url = "".join(each.value for each in token.arguments if each.type == "string")
    else:
        return None
    return str(url).strip()


def _tokens(text: str) -> list[Any]:
    tokens = tinycss2.parse_component_value_list(text, skip_comments=True)
    return [token for token in tokens if token.type != "whitespace"]


@remembered
def as_transform(text: str, *whole: float) -> Matrix | None:
    """The product of a list of transforms; None where one of them is none.

    Args:
        text: The list.
        whole: What is 100 % along x and along y, and the size of the font; without them lengths are
            numbers and pixels.
    """
    if text.strip().lower() in ("", "none"):
        return IDENTITY
    matrix = IDENTITY
    for name, arguments in _functions(text, whole or (0.0, 0.0, 0.0)):
        one = _transform(name, arguments)
        if one is None:
            return None
        matrix = multiplied(matrix, one)
    return matrix if all(map(math.isfinite, matrix)) else None


def needs_whole(text: str) -> bool:
    """Whether a list of transforms has lengths that are shares of something else."""
    return "%" in text or "em" in text or "ex" in text


def _functions(text: str, whole: tuple[float, ...]) -> Iterator[tuple[str, list[float] | None]]:
    name = ""
    for token in _tokens(text):
        if token.type == "ident" and not name:
            name = token.lower_value  # A blank stands before its parenthesis.
        elif token.type == "() block" and name:
            yield name, _numbers_in(name, token.content, whole)
            name = ""
        elif token.type == "function" and not name:
            yield token.lower_name, _numbers_in(token.lower_name, token.arguments, whole)
        elif token != "," or name:
            yield "", None
    if name:
        yield "", None


_IN_TRANSFORMS = _PIXELS | {unit: ("deg", factor) for unit, factor in DEGREES.items()}


def _numbers_in(name: str, tokens: Sequence[Any], whole: tuple[float, ...]) -> list[float] | None:
    """Numbers, pixels, and angles in degrees."""
    found: list[float] = []
    for token in tokens:
        if token.type in ("whitespace", "comment") or token == ",":
            continue
        quantity = quantity_of(token, _IN_TRANSFORMS)
        if quantity is None or quantity.keys() - {"", "px", "deg", "%", "em", "ex"}:
            return None
        total = 0.0
        along = whole[1] if name == "translatey" or len(found) == 1 else whole[0]
        for unit, value in quantity.items():
            if unit == "%":
                value *= 0.01 * (1.0 if name.startswith("scale") else along)
            total += value * _FONT_UNITS[unit] * whole[2] if unit in _FONT_UNITS else value
        found.append(total)
    return found if all(map(math.isfinite, found)) else None


def _transform(name: str, numbers: list[float] | None) -> Matrix | None:
    match name, numbers:
        case "matrix", [a, b, c, d, e, f]:
            return (a, b, c, d, e, f)
        case "translate", [x]:
            return (1.0, 0.0, 0.0, 1.0, x, 0.0)
        case "translate", [x, y]:
            return (1.0, 0.0, 0.0, 1.0, x, y)
        case "translatex", [x]:
            return (1.0, 0.0, 0.0, 1.0, x, 0.0)
        case "translatey", [y]:
            return (1.0, 0.0, 0.0, 1.0, 0.0, y)
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
            there, back = (1.0, 0.0, 0.0, 1.0, x, y), (1.0, 0.0, 0.0, 1.0, -x, -y)
            return multiplied(multiplied(there, rotation(angle)), back)
        case "skewx", [angle]:
            return (1.0, 0.0, _native.tan(math.radians(angle)), 1.0, 0.0, 0.0)
        case "skewy", [angle]:
            return (1.0, _native.tan(math.radians(angle)), 0.0, 1.0, 0.0, 0.0)
    return None


def as_rotate(text: str) -> Matrix | None:
    """The transform of the property `rotate`: an angle, and an axis before or behind it."""
    axis: list[str] = []
    angle: float | None = None
    numbers: list[float] = []
    for token in _tokens(text):
        quantity = quantity_of(token, _IN_TRANSFORMS)
        if token.type == "ident":
            axis.append(token.lower_value)
        elif quantity is not None and quantity.keys() == {"deg"} and angle is None:
            angle = quantity["deg"]
        elif quantity is not None and quantity.keys() == {""}:
            numbers.append(quantity[""])
        else:
            return None
    # Other axes would turn it out of the plane.
    is_flat = axis in ([], ["z"]) if not numbers else not axis and len(numbers) == 3
    if angle is None or not is_flat or (numbers and (numbers[:2] != [0.0, 0.0] or not numbers[2])):
        return None
    return rotation(-angle if numbers and numbers[2] < 0.0 else angle)


def as_path(text: str) -> str | None:
    """The path data that the property `d` holds; None for what is none."""
    tokens = _tokens(text)
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
    """By an angle in degrees."""
    # Quarters of a turn are exact, so that upright edges stay upright.
    quarters, rest = divmod(angle, 90.0)
    cos, sin = _native.cos(math.radians(angle)), _native.sin(math.radians(angle))
    if rest == 0.0:
        cos, sin = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    return (cos, sin, -sin, cos, 0.0, 0.0)
