# SPDX-License-Identifier: GPL-3.0-or-later

"""The state in which an element is read, and the resources shared by all elements."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from ..._fonts.bitmaps import Bitmap
from ...affine import Matrix
from ..model.gradients import Colors
from ..model.limits import Budget
from ..model.outline import Outline
from ..model.tree import Box, Clip, Group
from ..model.values import Length, Paint, parse_paint
from ..model.warnings import Warnings
from .basic_shapes import read_shape
from .document import Document, SvgElement
from .fonts import FontSources
from .image_files import Texels
from .lengths import Units, read_length
from .paint_servers import PaintServers
from .styles import Style, StyleSheets


@dataclass(frozen=True, slots=True)
class Sources:
    """Resources shared by all elements of a document.

    Attributes:
        folder: The drawing's folder, for images; None if there is none.
        waiting: A stack of elements to draw; the next one is last.
        outlines: Known outlines of basic shapes.
        circular: Elements whose masks contain themselves.
        letters: Decoded bitmap glyphs.
        measure: Returns the bounding box of an element's fill.
    """

    document: Document
    sheets: StyleSheets
    servers: PaintServers
    warnings: Warnings
    budget: Budget
    fonts: FontSources
    folder: Path | None = None
    waiting: list[tuple[SvgElement, "Context"]] = field(default_factory=list)
    outlines: dict[tuple[SvgElement, Units], Outline | None] = field(default_factory=dict)
    circular: set[SvgElement] = field(default_factory=set)
    letters: dict[Bitmap, Texels] = field(default_factory=dict)
    measure: "Callable[[SvgElement, Context, Sources], Box | None] | None" = None

    def pixels(self, element: SvgElement, name: str, default: Length, units: Units) -> float:
        """Returns a length attribute in pixels, or the default if missing."""
        declared = self.sheets.declared(element)
        length = read_length(element, declared, name, self.warnings)
        return units.pixels(default if length is None else length, name)

    def resolve_url(self, text: str) -> SvgElement | None:
        """Returns the element that a `url(#id)` refers to."""
        paint = parse_paint(text)
        if paint is None or not paint.server.startswith("#"):
            return None
        return self.document.ids.get(paint.server[1:])

    def outline(self, element: SvgElement, units: Units) -> Outline | None:
        """Returns the outline of a basic shape; None if it has none."""
        key = (element, units)
        if key not in self.outlines:
            declared = self.sheets.declared(element)
            self.outlines[key] = read_shape(element, declared, units, self.warnings)
        return self.outlines[key]

    def schedule(self, drawn: Iterable[tuple[SvgElement, "Context"]]) -> None:
        """Schedules elements to be drawn next, in order."""
        self.waiting.extend(reversed(list(drawn)))


@dataclass(frozen=True, slots=True)
class Context:
    """The state in which an element is read.

    Attributes:
        style: The parent's style.
        matrix: From the parent's units to the tree's.
        viewport: Width and height of the nearest viewport, in its units.
        target: The group that receives items.
        colors: The encoding of colors.
        clips: Clips that apply.
        uses: Elements referenced by the enclosing `use` elements.
        use: The `use` that directly refers to this element.
        paints: Values of `context-fill` and `context-stroke`.
    """

    style: Style
    matrix: Matrix
    viewport: tuple[float, float]
    target: Group
    colors: Colors
    clips: tuple[Clip, ...] = ()
    uses: tuple[SvgElement, ...] = ()
    use: SvgElement | None = None
    paints: Mapping[str, "ContextPaint"] = field(default_factory=dict)

    @property
    def units(self) -> Units:
        return Units(*self.viewport, self.style.font_size)


@dataclass(frozen=True, slots=True)
class ContextPaint:
    """The value of `context-fill` or `context-stroke`.

    Attributes:
        element: Its element, in whose units gradients and patterns lie.
        context: The context within that element.
    """

    paint: Paint
    element: SvgElement
    context: Context


def context_paints(element: SvgElement, context: Context) -> dict[str, ContextPaint]:
    """Returns `context-fill` and `context-stroke` for the contents that an element refers to."""
    paints = {}
    for name, paint in (
        ("context-fill", context.style.fill),
        ("context-stroke", context.style.stroke),
    ):
        if isinstance(paint.color, str) and paint.color != "current":
            held = context.paints.get(paint.color)
            paints[name] = ContextPaint(Paint(None), element, context) if held is None else held
            continue
        if paint.color == "current":
            paint = replace(paint, color=context.style.color)
        paints[name] = ContextPaint(paint, element, context)
    return paints
