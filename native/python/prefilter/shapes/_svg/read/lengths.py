# SPDX-License-Identifier: GPL-3.0-or-later

"""Lengths of attributes in user units."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ...affine import IDENTITY, Matrix, compose, translation
from ..model.values import Length, UnknownUnitError, parse_length, parse_origin
from ..model.warnings import Warnings
from .document import SvgElement

_ALONG_X = frozenset(("x", "x1", "x2", "cx", "fx", "rx", "width", "refX", "markerWidth"))
_ALONG_Y = frozenset(("y", "y1", "y2", "cy", "fy", "ry", "height", "refY", "markerHeight"))


@dataclass(frozen=True, slots=True)
class Units:
    """References of percentages and font units: viewport size, and font size."""

    width: float
    height: float
    font_size: float

    def pixels(self, length: Length, name: str) -> float:
        """Converts the value of an attribute or property to pixels."""
        if name in _ALONG_X:
            whole = self.width
        elif name in _ALONG_Y:
            whole = self.height
        else:
            whole = math.sqrt((self.width * self.width + self.height * self.height) / 2.0)
        return length.pixels(whole, self.font_size)


def transform_about_origin(
    matrix: Matrix, text: str, units: Units, corner: tuple[float, float] = (0.0, 0.0)
) -> Matrix | None:
    """Applies `transform-origin`, the text, to a transform; returns None if the text is invalid.

    Args:
        units: Size of the reference box.
        corner: Upper left corner of the reference box.
    """
    origin = parse_origin(text)
    if origin is None or matrix == IDENTITY:
        return None if origin is None else matrix
    x, y = corner[0] + units.pixels(origin[0], "x"), corner[1] + units.pixels(origin[1], "y")
    matrix = compose(translation(x, y), matrix)
    return compose(matrix, translation(-x, -y))


def read_length(
    element: SvgElement, values: Mapping[str, str], name: str, warnings: Warnings
) -> Length | None:
    """Reads the length of an attribute or property; returns None if missing, `auto` or invalid."""
    text = values.get(name)
    if text is None or text == "auto":
        return None
    try:
        length = parse_length(text)
    except UnknownUnitError as error:
        warnings.unsupported(f"unit '{error}'", "ignored", element.line)
        return None
    if length is None:
        warnings.broken(f"{name} '{text[:40]}'", "ignored", element.line)
    return length
