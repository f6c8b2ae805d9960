# SPDX-License-Identifier: GPL-3.0-or-later

"""viewBox and preserveAspectRatio: fitting user units into a rectangle."""

import re
from dataclasses import dataclass

from ...affine import Matrix
from .values import leading_numbers

_ALIGNMENT = re.compile(r"x(Min|Mid|Max)Y(Min|Mid|Max)(?:\s+(meet|slice))?")
# Largest side and coordinate, in units, and inverse of the smallest side.
MAX_UNITS = 1e9
_SHARES = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}


@dataclass(frozen=True, slots=True)
class ViewBox:
    """The part of the plane that a viewport shows; both sides are positive."""

    x: float
    y: float
    width: float
    height: float


def parse_view_box(text: str | None) -> ViewBox | None:
    """Parses `viewBox`; returns None if invalid."""
    if text is None:
        return None
    numbers, is_complete = leading_numbers(text)
    if not is_complete or len(numbers) != 4 or min(numbers[2:]) < 1.0 / MAX_UNITS:
        return None
    if max(map(abs, numbers)) > MAX_UNITS:
        return None
    return ViewBox(*numbers)


def fit_view_box(view: ViewBox, aspect: str, width: float, height: float) -> Matrix:
    """Returns the matrix that fits a view box into the rectangle from (0, 0) to (width, height).

    Args:
        aspect: The attribute preserveAspectRatio; invalid values count as the default.
    """
    scale_x, scale_y = width / view.width, height / view.height
    share_x = share_y = 0.0
    if aspect.strip() != "none":
        match = _ALIGNMENT.fullmatch(aspect.strip())
        is_slice = match is not None and match[3] == "slice"
        scale_x = scale_y = max(scale_x, scale_y) if is_slice else min(scale_x, scale_y)
        share_x = _SHARES[match[1]] if match else 0.5
        share_y = _SHARES[match[2]] if match else 0.5
    return (
        scale_x,
        0.0,
        0.0,
        scale_y,
        share_x * (width - view.width * scale_x) - view.x * scale_x,
        share_y * (height - view.height * scale_y) - view.y * scale_y,
    )
