# SPDX-License-Identifier: GPL-3.0-or-later

"""From elements to what is painted, in the order in which it is."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

from .basic_shapes import BASIC_SHAPES, read_shape
from .clip_paths import clipped
from .context import Context, Sources
from .document import Document, SvgElement
from .groups import Groups, carried
from .lengths import Units
from .limits import Budget, check_uses
from .nesting import children, used, viewport
from .outline import Outline
from .page import read_page
from .paint_servers import Colors, PaintServers
from .painted import Painted, Stroke
from .painting import paint_order, resolved, stroke_of
from .styles import UNSUPPORTED, Style, StyleSheets
from .tags import GROUPS, NOT_DRAWN
from .values import IDENTITY, Matrix, Paint, as_transform, determinant, multiplied
from .warnings import Warnings

# In widths or heights of the drawing. No shape may be more than 1e9 pixels away.
_LARGEST = 1e5
_SMALLEST_DETERMINANT = 1e-40


class Drawing:
    """What a document paints.

    Attributes:
        width: In pixels.
        height: In pixels.
        painted: First what is below.
    """

    def __init__(
        self,
        document: Document,
        colors: Colors,
        warnings: Warnings,
        tell: Callable[[float], None],
    ) -> None:
        sheets = StyleSheets(document, warnings, lambda share: tell(0.5 * share))
        servers = PaintServers(document, sheets, colors, warnings)
        check_uses(document)
        self._sources = Sources(document, sheets, servers, colors, warnings, Budget(document.count))
        self._tell = tell
        self._outlines: dict[tuple[SvgElement, Units], Outline | None] = {}
        self.painted: list[Painted] = []
        self._page = read_page(self._sources)
        self.width, self.height = self._page.width, self._page.height
        view = self._page.view
        box = (view.x, view.y, view.x + view.width, view.y + view.height)
        self._groups = Groups(box, warnings)
        self._draw()
        self._groups.check()

    def placement(self, width: float, height: float) -> Matrix:
        """From the drawing's units to pixels of an image, with y upwards."""
        return self._page.placement(width, height)

    def _draw(self) -> None:
        root = self._sources.document.root
        context = Context(Style(), IDENTITY, (self._page.view.width, self._page.view.height))
        # The next one is the last.
        waiting: list[tuple[SvgElement, Context]] = [(root, context)]
        count = 0
        while waiting:
            element, context = waiting.pop()
            count += 1
            if count % 100 == 0:
                # With `use` there may be more than there are elements.
                self._tell(0.5 + 0.5 * min(count / self._sources.document.count, 0.99))
            self._sources.budget.take_element()
            waiting.extend(reversed(list(self._visit(element, context))))

    def _visit(self, element: SvgElement, context: Context) -> Iterator[tuple[SvgElement, Context]]:
        """Paints an element; yields those in it."""
        tag, declared = element.tag, self._sources.sheets.declared(element)
        if tag in NOT_DRAWN or tag.startswith("{") or declared.get("display", "") == "none":
            return
        if tag == "symbol" and context.use is None:
            return
        if tag not in GROUPS and tag not in BASIC_SHAPES and tag != "use":
            self._sources.warnings.unsupported(f"<{tag}>", "left out", element.line)
            return
        style = self._sources.sheets.style_below(element, context.style)
        matrix = as_transform(declared.get("transform", ""))
        if matrix is None:
            self._sources.warnings.broken("transform", "ignored", element.line)
            matrix = IDENTITY
        context = replace(
            context,
            style=style,
            matrix=multiplied(context.matrix, matrix),
            opacity=context.opacity * style.opacity,
        )
        if abs(determinant(context.matrix)) < _SMALLEST_DETERMINANT or context.opacity == 0.0:
            return
        if style.opacity < 1.0:
            number = self._groups.add_translucent(element)
            context = replace(context, groups=(*context.groups, number))
        context = clipped(element, declared, context, self._sources, self._groups)
        for name in declared.keys() & UNSUPPORTED.keys():
            if declared[name].lower() not in UNSUPPORTED[name]:
                self._sources.warnings.unsupported(name, "ignored", element.line)
        if tag in BASIC_SHAPES:
            self._paint(element, context)
            return
        if tag == "use":
            yield from used(element, context, self._sources)
            return
        if tag in ("svg", "symbol") and element is not self._sources.document.root:
            inner = viewport(element, declared, context, self._sources, self._groups)
            if inner is None:
                return
            context = inner
        context = replace(context, use=None)
        yield from ((child, context) for child in children(element))

    def _paint(self, element: SvgElement, context: Context) -> None:
        style = context.style
        if style.visibility != "visible":
            return
        key = (element, context.units)
        if key not in self._outlines:
            declared = self._sources.sheets.declared(element)
            self._outlines[key] = read_shape(
                element, declared, context.units, self._sources.warnings
            )
        outline = self._outlines[key]
        if outline is None:
            return
        stroke = stroke_of(element, context, outline, self._sources)
        for part in paint_order(style.paint_order):
            if part == "fill" and element.tag != "line":
                self._add(element, context, outline, style.fill, style.fill_opacity, None)
            elif part == "stroke" and stroke is not None:
                self._add(element, context, outline, style.stroke, style.stroke_opacity, stroke)

    def _add(
        self,
        element: SvgElement,
        context: Context,
        outline: Outline,
        paint: Paint,
        opacity: float,
        stroke: Stroke | None,
    ) -> None:
        found = resolved(element, context, outline, paint, opacity * context.opacity, self._sources)
        if found is None:
            return
        rule = context.style.fill_rule
        painted = Painted(outline, rule, context.matrix, found, stroke)
        bounds = outline.bounds()
        assert bounds is not None
        margin = 0.0
        if stroke is not None:
            longest = stroke.miter_limit if stroke.join == "miter" else 1.0
            margin = 0.5 * stroke.width * max(longest, math.sqrt(2.0))
        left, top, right, bottom = bounds
        box = (left - margin, top - margin, right + margin, bottom + margin)
        box = carried(box, context.matrix)
        if not all(
            abs(value) < _LARGEST * max(self._page.view.width, self._page.view.height)
            for value in box
        ):
            self._sources.warnings.broken(
                f"<{element.tag}>", "left out, as it is too far away", element.line
            )
            return
        self._sources.budget.take_segments(len(outline), stroke.dash_count if stroke else 0.0)
        self.painted.append(painted)
        self._groups.put(context.groups, box)
