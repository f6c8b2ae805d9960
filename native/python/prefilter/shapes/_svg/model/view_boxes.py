# SPDX-License-Identifier: GPL-3.0-or-later

"""How the units of a drawing are placed in a rectangle: viewBox and preserveAspectRatio."""

import re
from dataclasses import dataclass

from ...affine import Matrix
from .values import leading_numbers

_ALIGNMENT = re.compile(r"x(Min|Mid|Max)Y(Min|Mid|Max)(?:\s+(meet|slice))?")
# A side has at most so many units; what is larger or smaller is a mistake.
MOST_UNITS = 1e9
_SHARES = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}


@dataclass(frozen=True, slots=True)
class ViewBox:
    """The part of the plane that a viewport shows; both sides are positive."""

    x: float
    y: float
    width: float
    height: float


def as_view_box(text: str | None) -> ViewBox | None:
    """The view box that an attribute holds; None for what is none."""
    if text is None:
        return None
    numbers, is_whole = leading_numbers(text)
    if not is_whole or len(numbers) != 4 or min(numbers[2:]) < 1.0 / MOST_UNITS:
        return None
    if max(map(abs, numbers)) > MOST_UNITS:
        return None
    return ViewBox(*numbers)


def placed(view: ViewBox, aspect: str, width: float, height: float) -> Matrix:
    """What carries a view box into the rectangle from (0, 0) to (width, height).

    Args:
        view: The view box.
        aspect: The attribute preserveAspectRatio; what is none stands for the default.
        width: Of the rectangle.
        height: Of the rectangle.
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
