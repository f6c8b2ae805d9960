# SPDX-License-Identifier: GPL-3.0-or-later

"""Where an element of a drawing stands, and what all elements are read with."""

from dataclasses import dataclass

from .document import Document, SvgElement
from .lengths import Units, read_length
from .limits import Budget
from .paint_servers import Colors, PaintServers
from .styles import Style, StyleSheets
from .values import Length, Matrix
from .warnings import Warnings


@dataclass(frozen=True, slots=True)
class Sources:
    """What all elements are read with."""

    document: Document
    sheets: StyleSheets
    servers: PaintServers
    colors: Colors
    warnings: Warnings
    budget: Budget

    def pixels(self, element: SvgElement, name: str, default: Length, units: Units) -> float:
        """An attribute of an element, or what stands for it where there is none."""
        declared = self.sheets.declared(element)
        length = read_length(element, declared, name, self.warnings)
        return units.pixels(default if length is None else length, name)


@dataclass(frozen=True, slots=True)
class Context:
    """Where an element stands.

    Attributes:
        style: Of its parent.
        matrix: From its parent's units to those of the drawing.
        viewport: Width and height of the nearest viewport, in its units.
        opacity: Of all groups around it.
        groups: Those of them that are seen as one, by number.
        uses: The elements that `use` has brought here.
        use: The `use` that brought this very element.
    """

    style: Style
    matrix: Matrix
    viewport: tuple[float, float]
    opacity: float = 1.0
    groups: tuple[int, ...] = ()
    uses: tuple[SvgElement, ...] = ()
    use: SvgElement | None = None

    @property
    def units(self) -> Units:
        return Units(*self.viewport, self.style.font_size)
