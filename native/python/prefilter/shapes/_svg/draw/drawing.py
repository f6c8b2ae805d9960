# SPDX-License-Identifier: GPL-3.0-or-later

"""From elements to a tree of what is painted, in the order in which it is."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from ...affine import IDENTITY, Matrix, determinant, inverse, multiplied
from ...shape import Shape
from ..filters.filter_property import filters_of
from ..model.clips import make_box_clip
from ..model.gradients import Colors, Gradient
from ..model.limits import Budget
from ..model.outline import Outline
from ..model.tree import Box, Clip, Group, Painted, Pattern, Stroke, transform_box
from ..model.values import Paint
from ..model.view_boxes import fit_view_box
from ..model.warnings import Warnings
from ..paint.bounds import object_bounds
from ..paint.clip_paths import clipped
from ..paint.images import Images, draw_image
from ..paint.markers import MARKED, draw_markers
from ..paint.masks import masks_of
from ..paint.paints import paint_order, resolved, stroke_of
from ..read.basic_shapes import BASIC_SHAPES
from ..read.context import Context, Sources
from ..read.document import Document, SvgElement, read_document
from ..read.fonts import FontSources
from ..read.nesting import (
    FOREIGN,
    RENDERED_TAGS,
    VISIBLE_OVERFLOW,
    enter_element,
    enter_viewport,
    passes_conditions,
    rendered_children,
    resolve_use,
)
from ..read.page import Page, read_background, read_page
from ..read.paint_servers import PaintServers
from ..read.references import check_repetition
from ..read.styles import UNSUPPORTED, Style, StyleSheets
from ..read.tags import NOT_DRAWN

Tell = Callable[[float], None]

# Squares of larger coordinates might not be finite.
_LARGEST = 1e100
_SMALLEST_DETERMINANT = 1e-40
_MAX_NESTED = 8
# Of the larger side: what rounding makes of a page that fits.
_SLACK = 1e-9


@dataclass(frozen=True, slots=True)
class _Drawn:
    """An outline that is painted.

    Attributes:
        box: Around it.
        bounds: The box that shares of it are of; None where there is none.
    """

    outline: Outline
    box: Box
    bounds: Box | None


class Drawing:
    """What a document paints.

    Attributes:
        page: How large it is.
        tree: What is on it, in its units.
        background: The color of the page; None where it has none.
    """

    def __init__(
        self,
        document: Document,
        colors: Colors,
        warnings: Warnings,
        report: Tell,
        fonts: FontSources,
    ) -> None:
        walk = TreeBuilder(document, warnings, report, 0, Budget(document.count), fonts)
        self.page = walk.page
        self.tree = Group(is_isolated=True)
        self._is_open = (
            walk.sources.sheets.declared(document.root).get("overflow") in VISIBLE_OVERFLOW
        )
        self.background = read_background(walk.sources, colors)
        walk.draw_in(IDENTITY, (), self.tree, colors)

    def placement(self, width: float, height: float) -> tuple[Matrix, tuple[Clip, ...]]:
        """From the tree's units to pixels of an image, with y upwards; and what it is cut off at.

        The page is all of an image that has its proportions.
        """
        to_pixels = self.page.placement(width, height)
        left, low, right, high = transform_box(self.page.shown(), to_pixels)
        slack = _SLACK * max(width, height)
        if left <= slack and low <= slack and right >= width - slack and high >= height - slack:
            return to_pixels, ()
        return to_pixels, self._clips()

    def placed(self, scale: float, x: float, y: float) -> tuple[Matrix, tuple[Clip, ...]]:
        """The same where the lower left corner of the page is at (x, y), enlarged by a factor."""
        to_pixels = self.page.placement(scale * self.page.width, scale * self.page.height)
        return multiplied((1.0, 0.0, 0.0, 1.0, x, y), to_pixels), self._clips()

    def _clips(self) -> tuple[Clip, ...]:
        """What the drawing is cut off at: its page."""
        if self._is_open:
            return ()
        return (make_box_clip(self.page.shown(), IDENTITY),)

    def background_in(self, to_pixels: Matrix) -> Shape | None:
        """The page as a shape of its color; None where it has none."""
        if self.background is None:
            return None
        left, low, right, high = transform_box(self.page.shown(), to_pixels)
        shape = Shape(color=self.background)
        shape.add_polygon([(left, low), (right, low), (right, high), (left, high)])
        return shape


class TreeBuilder:
    """Draws the elements of a document."""

    def __init__(
        self,
        document: Document,
        warnings: Warnings,
        report: Tell,
        depth: int,
        budget: Budget,
        fonts: FontSources,
    ) -> None:
        sheets = StyleSheets(document, warnings, lambda share: report(0.5 * share))
        servers = PaintServers(document, sheets, warnings)
        check_repetition(document, sheets)
        own = fonts.with_rules(sheets.font_rules, warnings)
        self._fonts = fonts
        self.sources = Sources(
            document,
            sheets,
            servers,
            warnings,
            budget,
            own,
            document.folder,
            measure=object_bounds,
        )
        self.page: Page = read_page(self.sources)
        self._report = report
        self._depth = depth
        self._images = Images(self._nested)

    def draw_in(
        self, matrix: Matrix, clips: tuple[Clip, ...], target: Group, colors: Colors
    ) -> None:
        """Draws all of it; the matrix leads from its units to those of the tree."""
        sources = self.sources
        size = (self.page.view.width, self.page.view.height)
        root = sources.document.root
        sources.waiting.append((root, Context(Style(), matrix, size, target, colors, clips)))
        count = 0
        while sources.waiting:
            element, context = sources.waiting.pop()
            count += 1
            if count % 100 == 0:
                # With `use` there may be more than there are elements.
                self._report(0.5 + 0.5 * min(count / sources.document.count, 0.99))
            sources.budget.take_element()
            sources.schedule(self._visit(element, context))

    def _visit(self, element: SvgElement, context: Context) -> Iterator[tuple[SvgElement, Context]]:
        """Paints an element; yields those in it."""
        sources = self.sources
        tag, declared = element.tag, sources.sheets.declared(element)
        if tag == "script":
            sources.warnings.unsupported("<script>", "not run", element.line)
        if tag in NOT_DRAWN or tag.startswith("{") or declared.get("display", "") == "none":
            return
        if not passes_conditions(element) and element is not sources.document.root:
            return
        if tag == "symbol" and context.use is None:
            return
        if tag not in RENDERED_TAGS:
            sources.warnings.unsupported(f"<{tag}>", "left out", element.line)
            return
        foreign = [child for child in element if child.tag == FOREIGN] if tag == "switch" else []
        if foreign:
            effect = "replaced by what follows it" if element[-1] not in foreign else "left out"
            sources.warnings.unsupported(f"<{FOREIGN}>", effect, element.line)
        inside = self._within(element, enter_element(element, context, sources))
        if inside is None:
            return
        if tag in BASIC_SHAPES:
            self._paint(element, inside)
        elif tag == "text":
            self._paint_text(element, inside)
        elif tag == "image":
            draw_image(element, inside, sources, self._images)
        elif tag == "use":
            yield from resolve_use(element, inside, sources)
        else:
            if tag in ("svg", "symbol") and element is not sources.document.root:
                inside = enter_viewport(element, inside, sources)
            if inside is not None:
                place = replace(inside, use=None)
                yield from ((child, place) for child in rendered_children(element))

    def _within(self, element: SvgElement, context: Context) -> Context | None:
        """The context within an element's opacity, mask and clip path; None where nothing shows."""
        style, sources = context.style, self.sources
        if abs(determinant(context.matrix)) < _SMALLEST_DETERMINANT or style.opacity == 0.0:
            return None
        declared = sources.sheets.declared(element)
        for name in declared.keys() & UNSUPPORTED.keys():
            if declared[name].lower() not in UNSUPPORTED[name]:
                sources.warnings.unsupported(name, "ignored", element.line)
        inside = clipped(element, context, sources)
        filters = filters_of(element, context, sources, self._images)
        masks = masks_of(element, context, sources)
        if inside is None or masks is None:
            return None
        is_isolated = (
            bool(masks)
            or bool(filters)
            or style.opacity < 1.0
            or style.mix_blend_mode != "normal"
            or style.isolation == "isolate"
            or inside.clips != context.clips
        )
        if is_isolated:
            group = Group(
                opacity=context.colors.opacity(style.opacity),
                blend=style.mix_blend_mode,
                masks=masks,
                filter=filters[-1] if filters else None,
                clips=inside.clips if filters else (),
                is_isolated=True,
                line=element.line,
            )
            context.target.items.append(group)
            for earlier in reversed(filters[:-1]):
                clip_box = Group(filter=earlier, is_isolated=True, line=element.line)
                group.items.append(clip_box)
                group = clip_box
            clips = () if filters else inside.clips
            inside = replace(inside, target=group, clips=clips)
        return inside

    def _paint(self, element: SvgElement, context: Context) -> None:
        outline = self.sources.outline(element, context.units)
        box = outline.bounds() if outline is not None else None
        if outline is not None and box is not None and context.style.visibility == "visible":
            self._paint_outline(element, context, _Drawn(outline, box, box))

    def _paint_text(self, element: SvgElement, context: Context) -> None:
        # Fonts take modules that those who draw no text need not wait for.
        from ..text.color_glyphs import ColoredPiece, draw_colored
        from ..text.text_elements import drawn_text

        drawn = drawn_text(element, context, self.sources)
        for piece in drawn.pieces:
            if isinstance(piece, ColoredPiece):
                draw_colored(piece, context, self.sources)
                continue
            place = replace(context, style=piece.style)
            outline = _Drawn(piece.outline, piece.box, drawn.bounds)
            self._paint_outline(piece.element, place, outline)

    def _paint_outline(self, element: SvgElement, context: Context, drawn: _Drawn) -> None:
        style, outline = context.style, drawn.outline
        stroke = stroke_of(element, context, outline, self.sources)
        for part in paint_order(style.paint_order):
            if part == "fill" and element.tag != "line":
                self._add(element, context, drawn, style.fill, style.fill_opacity, None)
            elif part == "stroke" and stroke is not None:
                self._add(element, context, drawn, style.stroke, style.stroke_opacity, stroke)
            elif part == "markers" and element.tag in MARKED:
                draw_markers(element, context, outline, self.sources)

    def _add(
        self,
        element: SvgElement,
        context: Context,
        drawn: _Drawn,
        paint: Paint,
        opacity: float,
        stroke: Stroke | None,
    ) -> None:
        found = resolved(element, context, drawn.bounds, paint, opacity, self.sources)
        if found is None:
            return
        if stroke is not None and self._is_unscaled(element):
            context, drawn, found = self._on_page(context, drawn, found)
        outline = drawn.outline
        margin = 0.0
        if stroke is not None:
            longest = stroke.miter_limit if stroke.join == "miter" else 1.0
            margin = 0.5 * stroke.width * max(longest, math.sqrt(2.0))
        left, top, right, bottom = drawn.box
        box = (left - margin, top - margin, right + margin, bottom + margin)
        box = transform_box(box, context.matrix)
        if not all(abs(value) < _LARGEST for value in box):
            self.sources.warnings.broken(
                f"<{element.tag}>", "left out, as it is too far away", element.line
            )
            return
        # As browsers: what is drawn fast has no soft edges either.
        is_crisp = element.tag != "text" and context.style.shape_rendering in (
            "crispedges",
            "optimizespeed",
        )
        self.sources.budget.take_segments(len(outline), stroke.dash_count if stroke else 0.0)
        rule = context.style.fill_rule
        matrix, clips = context.matrix, context.clips
        context.target.items.append(
            Painted(outline, rule, matrix, found, stroke, clips, box, element.line, is_crisp)
        )

    def _is_unscaled(self, element: SvgElement) -> bool:
        """Whether strokes are as wide as they say on the page, however an element is moved."""
        effect = self.sources.sheets.declared(element).get("vector-effect", "none")
        return effect.strip().lower() == "non-scaling-stroke"

    def _on_page(
        self, context: Context, drawn: _Drawn, paint: tuple[float, ...] | Gradient | Pattern
    ) -> tuple[Context, _Drawn, tuple[float, ...] | Gradient | Pattern]:
        """The same in pixels of the page."""
        page = self.page
        to_page = fit_view_box(page.view, page.aspect, page.width, page.height)
        own = multiplied(to_page, context.matrix)
        outline = drawn.outline.transformed(own)
        if not isinstance(paint, tuple):
            paint = replace(paint, matrix=multiplied(own, paint.matrix))
        box = outline.bounds() or drawn.box
        context = replace(context, matrix=inverse(to_page))
        return context, _Drawn(outline, box, drawn.bounds), paint

    def _nested(self, data: bytes, name: str) -> "TreeBuilder":
        """A drawing in this one; nothing in it comes from other files."""
        if self._depth >= _MAX_NESTED:
            raise ValueError(f"as drawings are nested more than {_MAX_NESTED} deep")
        document = read_document(data, lambda _: None)
        document.name = name
        sources = self.sources
        return TreeBuilder(
            document,
            sources.warnings,
            lambda _: None,
            self._depth + 1,
            sources.budget,
            self._fonts,
        )
