# SPDX-License-Identifier: GPL-3.0-or-later

"""Where an element of a drawing stands, and what all elements are read with."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from ..._fonts.bitmaps import Bitmap
from ...affine import Matrix
from ..model.gradients import Colors
from ..model.limits import Budget
from ..model.outline import Outline
from ..model.tree import Box, Clip, Group
from ..model.values import Length, Paint, as_paint
from ..model.warnings import Warnings
from .basic_shapes import read_shape
from .document import Document, SvgElement
from .fonts import FontPlaces
from .image_files import Texels
from .lengths import Units, read_length
from .paint_servers import PaintServers
from .styles import Style, StyleSheets


@dataclass(frozen=True, slots=True)
class Sources:
    """What all elements are read with.

    Attributes:
        fonts: Those for text.
        folder: Where images beside the drawing are; None where there are none.
        waiting: The elements to be drawn, of which the next one is the last.
        outlines: Those that are known, by element.
        circular: Elements whose masks would mask themselves.
        letters: The texels of letters that are pictures, read once.
        measure: Returns the box around what an element fills.
    """

    document: Document
    sheets: StyleSheets
    servers: PaintServers
    warnings: Warnings
    budget: Budget
    fonts: FontPlaces
    folder: Path | None = None
    waiting: list[tuple[SvgElement, "Context"]] = field(default_factory=list)
    outlines: dict[tuple[SvgElement, Units], Outline | None] = field(default_factory=dict)
    circular: set[SvgElement] = field(default_factory=set)
    letters: dict[Bitmap, Texels] = field(default_factory=dict)
    measure: "Callable[[SvgElement, Context, Sources], Box | None] | None" = None

    def pixels(self, element: SvgElement, name: str, default: Length, units: Units) -> float:
        """An attribute of an element, or what stands for it where there is none."""
        declared = self.sheets.declared(element)
        length = read_length(element, declared, name, self.warnings)
        return units.pixels(default if length is None else length, name)

    def referred(self, text: str) -> SvgElement | None:
        """The element that a `url(#id)` refers to."""
        paint = as_paint(text)
        if paint is None or not paint.server.startswith("#"):
            return None
        return self.document.ids.get(paint.server[1:])

    def outline(self, element: SvgElement, units: Units) -> Outline | None:
        """The outline of a basic shape; None where it has none."""
        key = (element, units)
        if key not in self.outlines:
            declared = self.sheets.declared(element)
            self.outlines[key] = read_shape(element, declared, units, self.warnings)
        return self.outlines[key]

    def draw(self, drawn: Iterable[tuple[SvgElement, "Context"]]) -> None:
        """Has elements drawn, in their order."""
        self.waiting.extend(reversed(list(drawn)))


@dataclass(frozen=True, slots=True)
class Context:
    """Where an element stands.

    Attributes:
        style: Of its parent.
        matrix: From its parent's units to those of the tree.
        viewport: Width and height of the nearest viewport, in its units.
        target: What it becomes a part of.
        colors: How colors are kept.
        clips: What it is cut off at.
        uses: The elements that others have brought here by reference.
        use: The `use` that brought this very element.
        paints: What `context-fill` and `context-stroke` stand for.
    """

    style: Style
    matrix: Matrix
    viewport: tuple[float, float]
    target: Group
    colors: Colors
    clips: tuple[Clip, ...] = ()
    uses: tuple[SvgElement, ...] = ()
    use: SvgElement | None = None
    paints: Mapping[str, "HeldPaint"] = field(default_factory=dict)

    @property
    def units(self) -> Units:
        return Units(*self.viewport, self.style.font_size)


@dataclass(frozen=True, slots=True)
class HeldPaint:
    """What `context-fill` or `context-stroke` stands for.

    Attributes:
        paint: It.
        element: The one that has it: gradients and patterns lie as they do there.
        context: Within that.
    """

    paint: Paint
    element: SvgElement
    context: Context


def paints_of(element: SvgElement, context: Context) -> dict[str, HeldPaint]:
    """What `context-fill` and `context-stroke` stand for in what an element brings."""
    found = {}
    for name, paint in (
        ("context-fill", context.style.fill),
        ("context-stroke", context.style.stroke),
    ):
        if isinstance(paint.color, str) and paint.color != "current":
            held = context.paints.get(paint.color)
            found[name] = HeldPaint(Paint(None), element, context) if held is None else held
            continue
        if paint.color == "current":
            paint = replace(paint, color=context.style.color)
        found[name] = HeldPaint(paint, element, context)
    return found
