# SPDX-License-Identifier: GPL-3.0-or-later

"""How large a drawing is, and where its units lie in it."""

from dataclasses import dataclass

import numpy as np

from ...affine import Matrix, multiplied
from ..model.gradients import Colors
from ..model.tree import Box
from ..model.values import Length, as_background
from ..model.view_boxes import MOST_UNITS, ViewBox, as_view_box, placed
from .context import Sources
from .lengths import read_length

_WHOLE = Length(100.0, "%")


@dataclass(frozen=True, slots=True)
class Page:
    """How large a drawing is.

    Attributes:
        width: In pixels.
        height: In pixels.
        view: In its units.
        aspect: How the view is fitted: `preserveAspectRatio`.
        has_size: Whether the file says a width or a height.
    """

    width: float
    height: float
    view: ViewBox
    aspect: str
    has_size: bool = True

    def placement(self, width: float, height: float) -> Matrix:
        """From the drawing's units to pixels of an image, with y upwards."""
        upwards = (1.0, 0.0, 0.0, -1.0, 0.0, height)
        return multiplied(upwards, placed(self.view, self.aspect, width, height))

    def shown(self) -> Box:
        """What the page shows, in the drawing's units: the view box, and what is beside it."""
        a, _, _, d, e, f = placed(self.view, self.aspect, self.width, self.height)
        return (-e / a, -f / d, (self.width - e) / a, (self.height - f) / d)


def read_page(sources: Sources) -> Page:
    """The page of a drawing.

    Raises:
        ValueError: The file says a size that no drawing has.
    """
    root = sources.document.root
    declared = sources.sheets.declared(root)
    view = as_view_box(declared.get("viewBox"))
    if view is None and "viewBox" in declared:
        sources.warnings.broken("viewBox", "ignored", root.line)
    sizes = []
    for name in ("width", "height"):
        length = read_length(root, declared, name, sources.warnings) or _WHOLE
        font_size = sources.sheets.style(root).font_size
        pixels = length.pixels(1.0, font_size)
        if not 0.0 < pixels < MOST_UNITS:
            raise ValueError(
                f"{sources.document.name}, line {root.line}: {name} '{declared[name]}'; a "
                f"drawing needs a positive one below {MOST_UNITS:g} pixels"
            )
        sizes.append(None if length.unit == "%" else pixels)
    width, height = sizes
    has_size = sizes != [None, None]
    # What a file does not say follows from its view box, and without one is CSS's 300 x 150.
    if view is not None:
        if width is None:
            width = view.width if height is None else height * view.width / view.height
        height = width * view.height / view.width if height is None else height
    width, height = width or 300.0, height or 150.0
    view = view or ViewBox(0.0, 0.0, width, height)
    return Page(width, height, view, declared.get("preserveAspectRatio", ""), has_size)


def background_of(sources: Sources, colors: Colors) -> tuple[float, ...] | None:
    """The color that the style of the outermost element gives to the page; None where none."""
    root = sources.document.root
    declared = sources.sheets.declared(root)
    color = as_background(declared.get("background-color", declared.get("background", "")))
    if color == "current":
        color = sources.sheets.style(root).color
    if color is None or isinstance(color, str) or color[3] == 0.0:
        return None
    values = np.array([[*color[:3], colors.opacity(color[3])]])
    return colors.premultiplied(values)[0]
