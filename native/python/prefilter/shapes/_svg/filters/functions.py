# SPDX-License-Identifier: GPL-3.0-or-later

"""Filter functions: `blur()`, `drop-shadow()`, and color functions."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import tinycss2

from ...affine import Matrix
from ..model.calculations import DEGREES
from ..model.colors import Color
from ..model.tree import Filter, Step
from ..model.values import parse_color, parse_length, parse_url
from ..read.lengths import Units
from .primitives import Matrix5, hue_rotation_matrix, saturation_matrix

MAX_FUNCTIONS = 32
_NAMES = frozenset(
    ("brightness", "contrast", "grayscale", "invert", "opacity", "saturate", "sepia", "hue-rotate")
)
_LIMITED = ("grayscale", "invert", "opacity", "sepia")
_SEPIA = np.array([[0.393, 0.769, 0.189], [0.349, 0.686, 0.168], [0.272, 0.534, 0.131]])


class InvalidFunctionError(Exception):
    """A value of `filter` is invalid."""


def parse_filter_list(text: str) -> list[Any]:
    """Parses a value of `filter` into function tokens, and addresses as text.

    Raises:
        InvalidFunctionError: The value is invalid.
    """
    filters: list[Any] = []
    for token in tinycss2.parse_component_value_list(text, skip_comments=True):
        if token.type == "whitespace":
            continue
        address = parse_url(token)
        if address is None and token.type != "function":
            raise InvalidFunctionError
        filters.append(token if address is None else address)
    if not filters or len(filters) > MAX_FUNCTIONS:
        raise InvalidFunctionError
    return filters


def filter_by_function(
    function: Any, matrix: Matrix, units: Units, color: Color, is_linear: bool
) -> Filter:
    """Converts a filter function to a filter.

    Args:
        matrix: From the element's units to the tree's.
        color: The value of currentcolor.
        is_linear: Whether the group's colors are decoded.

    Raises:
        InvalidFunctionError: The function is invalid.
    """
    arguments = [
        token for token in function.arguments if token.type not in ("whitespace", "comment")
    ]
    name = function.lower_name
    if name == "blur":
        deviation = _length(arguments[0], units) if arguments else 0.0
        # Browsers require a unit here, but not in drop-shadow().
        is_bare = bool(arguments) and arguments[0].type == "number" and deviation != 0.0
        if len(arguments) > 1 or deviation < 0.0 or is_bare:
            raise InvalidFunctionError
        step = _step("feGaussianBlur", [deviation, deviation])
    elif name == "drop-shadow":
        step = _step("feDropShadow", _shadow(arguments, units, color))
    elif name in _NAMES:
        step = _step("feColorMatrix", _color_matrix(name, arguments).ravel().tolist())
    else:
        raise InvalidFunctionError
    return Filter((step,), None, matrix, is_linear)


def _step(kind: str, numbers: Sequence[float]) -> Step:
    return Step(kind, ("",), "", tuple(numbers), "", False, None)


def _length(token: Any, units: Units) -> float:
    """Converts to pixels. Numbers need no unit, as in SVG attributes."""
    if token.type not in ("number", "dimension"):
        raise InvalidFunctionError
    try:
        length = parse_length(token.serialize())
    except ValueError:
        length = None
    if length is None:
        raise InvalidFunctionError
    return units.pixels(length, "")


def _shadow(arguments: list[Any], units: Units, current: Color) -> list[float]:
    """Returns deviations, offsets and color; the color precedes or follows the lengths."""
    color: Color = current
    for place in (0, -1):
        if arguments and arguments[place].type not in ("number", "dimension"):
            parsed = parse_color(arguments.pop(place).serialize())
            if parsed is None:
                raise InvalidFunctionError
            color = current if isinstance(parsed, str) else parsed
            break
    lengths = [_length(token, units) for token in arguments]
    if len(lengths) not in (2, 3) or (len(lengths) == 3 and lengths[2] < 0.0):
        raise InvalidFunctionError
    x, y, deviation = (*lengths, 0.0)[:3]
    return [deviation, deviation, x, y, *color]


def _color_matrix(name: str, arguments: list[Any]) -> Matrix5:
    """Returns a color matrix: rows of red, green, blue and alpha."""
    amount = 0.0 if name == "hue-rotate" else 1.0
    if len(arguments) > 1:
        raise InvalidFunctionError
    if arguments:
        amount = _angle(arguments[0]) if name == "hue-rotate" else _amount(arguments[0])
    if name in _LIMITED:
        amount = min(amount, 1.0)
    matrix = np.eye(4, 5)
    colors = matrix[:3]
    match name:
        case "brightness":
            colors *= amount
        case "contrast":
            colors *= amount
            colors[:, 4] = 0.5 - 0.5 * amount
        case "invert":
            colors *= 1.0 - 2.0 * amount
            colors[:, 4] = amount
        case "opacity":
            matrix[3] *= amount
        case "sepia":
            colors[:, :3] = _SEPIA + (1.0 - amount) * (np.eye(3) - _SEPIA)
        case "grayscale":
            matrix = saturation_matrix(1.0 - amount)
        case "saturate":
            matrix = saturation_matrix(amount)
        case _:
            matrix = hue_rotation_matrix(amount)
    return matrix


def _amount(token: Any) -> float:
    """Parses a nonnegative number or percentage."""
    if token.type not in ("number", "percentage") or not 0.0 <= token.value < 1e9:
        raise InvalidFunctionError
    return float(token.value) * (0.01 if token.type == "percentage" else 1.0)


def _angle(token: Any) -> float:
    """Converts to degrees."""
    if token.type == "number" and token.value == 0:
        return 0.0
    if token.type != "dimension" or token.lower_unit not in DEGREES or abs(token.value) > 1e9:
        raise InvalidFunctionError
    return float(token.value) * DEGREES[token.lower_unit]
