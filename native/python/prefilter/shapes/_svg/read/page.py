# SPDX-License-Identifier: GPL-3.0-or-later

"""The page of a drawing: its size, and the view box within it."""

from dataclasses import dataclass

import numpy as np

from ...affine import Matrix, compose
from ..model.gradients import Colors
from ..model.tree import Box
from ..model.values import Length, parse_background
from ..model.view_boxes import MAX_UNITS, ViewBox, fit_view_box, parse_view_box
from .context import Sources
from .lengths import read_length

_WHOLE = Length(100.0, "%")


@dataclass(frozen=True, slots=True)
class Page:
    """Size of a drawing in pixels, and its view box in user units.

    Attributes:
        aspect: `preserveAspectRatio`.
        has_size: Whether the file gives a width or a height.
    """

    width: float
    height: float
    view: ViewBox
    aspect: str
    has_size: bool = True

    def placement(self, width: float, height: float) -> Matrix:
        """Returns the matrix from user units to pixels of an image, y upwards."""
        upwards = (1.0, 0.0, 0.0, -1.0, 0.0, height)
        return compose(upwards, fit_view_box(self.view, self.aspect, width, height))

    def visible_box(self) -> Box:
        """Returns the visible box in user units: the view box and its surroundings."""
        a, _, _, d, e, f = fit_view_box(self.view, self.aspect, self.width, self.height)
        return (-e / a, -f / d, (self.width - e) / a, (self.height - f) / d)


def read_page(sources: Sources) -> Page:
    """Reads the page of a drawing.

    Raises:
        ValueError: Width or height is not valid.
    """
    root = sources.document.root
    declared = sources.sheets.declared(root)
    view = parse_view_box(declared.get("viewBox"))
    if view is None and "viewBox" in declared:
        sources.warnings.broken("viewBox", "ignored", root.line)
    sizes = []
    for name in ("width", "height"):
        length = read_length(root, declared, name, sources.warnings) or _WHOLE
        font_size = sources.sheets.style(root).font_size
        pixels = length.pixels(1.0, font_size)
        if not 0.0 < pixels < MAX_UNITS:
            raise ValueError(
                f"{sources.document.name}, line {root.line}: {name} '{declared[name]}'; a "
                f"drawing needs a positive one below {MAX_UNITS:g} pixels"
            )
        sizes.append(None if length.unit == "%" else pixels)
    width, height = sizes
    has_size = sizes != [None, None]
    # Missing sizes follow from the view box, or are CSS's default of 300 x 150.
    if view is not None:
        if width is None:
            width = view.width if height is None else height * view.width / view.height
        height = width * view.height / view.width if height is None else height
    width, height = width or 300.0, height or 150.0
    view = view or ViewBox(0.0, 0.0, width, height)
    return Page(width, height, view, declared.get("preserveAspectRatio", ""), has_size)


def read_background(sources: Sources, colors: Colors) -> tuple[float, ...] | None:
    """Returns the background color of the root element; None if it has none."""
    root = sources.document.root
    declared = sources.sheets.declared(root)
    color = parse_background(declared.get("background-color", declared.get("background", "")))
    if color == "current":
        color = sources.sheets.style(root).color
    if color is None or isinstance(color, str) or color[3] == 0.0:
        return None
    values = np.array([[*color[:3], colors.opacity(color[3])]])
    return colors.premultiplied(values)[0]
