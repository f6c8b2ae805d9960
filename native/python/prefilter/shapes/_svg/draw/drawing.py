# SPDX-License-Identifier: GPL-3.0-or-later

"""Building the tree of a document."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from ...affine import IDENTITY, Matrix, compose, determinant, inverse, translation
from ...shape import Shape
from ..filters.filter_property import read_filters
from ..model.gradients import Colors, Gradient
from ..model.limits import Budget
from ..model.outline import Outline
from ..model.tree import Box, Clip, Group, Painted, Pattern, Stroke, make_box_clip, transform_box
from ..model.values import Paint
from ..model.view_boxes import fit_view_box
from ..model.warnings import Warnings
from ..paint.bounds import object_bounds
from ..paint.clip_paths import apply_clip_path
from ..paint.images import Images, draw_image
from ..paint.markers import MARKED, draw_markers
from ..paint.masks import read_masks
from ..paint.paints import paint_order, resolve_paint, resolve_stroke
from ..read.basic_shapes import BASIC_SHAPES
from ..read.context import Context, Sources
from ..read.document import NOT_DRAWN, Document, SvgElement, read_document
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

Progress = Callable[[float], None]

# Squares of larger coordinates might overflow.
_LARGEST = 1e100
_SMALLEST_DETERMINANT = 1e-40
_MAX_NESTED = 8
# Relative rounding error allowed when comparing the page with an image.
_PAGE_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class _Paintable:
    """An outline to paint.

    Attributes:
        bounds: The bounding box for relative units; None if there is none.
    """

    outline: Outline
    box: Box
    bounds: Box | None


class Drawing:
    """A document's tree, with its page.

    Attributes:
        page: The size and view box.
        tree: The contents, in user units of the root.
        background: The background color; None if there is none.
    """

    def __init__(
        self,
        document: Document,
        colors: Colors,
        warnings: Warnings,
        report: Progress,
        fonts: FontSources,
    ) -> None:
        builder = TreeBuilder(document, warnings, report, 0, Budget(document.count), fonts)
        self.page = builder.page
        self.tree = Group(is_isolated=True)
        self._is_open = (
            builder.sources.sheets.declared(document.root).get("overflow") in VISIBLE_OVERFLOW
        )
        self.background = read_background(builder.sources, colors)
        builder.build(IDENTITY, (), self.tree, colors)

    def placement(self, width: float, height: float) -> tuple[Matrix, tuple[Clip, ...]]:
        """Returns the matrix from the tree's units to pixels of an image, y upwards, and the clips.

        An image with the proportions of the page needs no clips.
        """
        to_pixels = self.page.placement(width, height)
        left, low, right, high = transform_box(self.page.visible_box(), to_pixels)
        slack = _PAGE_TOLERANCE * max(width, height)
        if left <= slack and low <= slack and right >= width - slack and high >= height - slack:
            return to_pixels, ()
        return to_pixels, self._clips()

    def placement_at(self, scale: float, x: float, y: float) -> tuple[Matrix, tuple[Clip, ...]]:
        """Returns the same for a page scaled by a factor, with its lower left corner at (x, y)."""
        to_pixels = self.page.placement(scale * self.page.width, scale * self.page.height)
        return compose(translation(x, y), to_pixels), self._clips()

    def _clips(self) -> tuple[Clip, ...]:
        """Returns the clip at the page, unless overflow is visible."""
        if self._is_open:
            return ()
        return (make_box_clip(self.page.visible_box(), IDENTITY),)

    def background_in(self, to_pixels: Matrix) -> Shape | None:
        """Returns the page filled with the background color; None if there is none."""
        if self.background is None:
            return None
        left, low, right, high = transform_box(self.page.visible_box(), to_pixels)
        shape = Shape(color=self.background)
        shape.add_polygon([(left, low), (right, low), (right, high), (left, high)])
        return shape


class TreeBuilder:
    """Builds a tree from the elements of a document."""

    def __init__(
        self,
        document: Document,
        warnings: Warnings,
        report: Progress,
        depth: int,
        budget: Budget,
        fonts: FontSources,
    ) -> None:
        sheets = StyleSheets(document, warnings, lambda share: report(0.5 * share))
        servers = PaintServers(document, sheets, warnings)
        check_repetition(document, sheets)
        document_fonts = fonts.with_rules(sheets.font_rules, warnings)
        self._fonts = fonts
        self.sources = Sources(
            document,
            sheets,
            servers,
            warnings,
            budget,
            document_fonts,
            document.folder,
            measure=object_bounds,
        )
        self.page: Page = read_page(self.sources)
        self._report = report
        self._depth = depth
        self._images = Images(self._read_nested)

    def build(self, matrix: Matrix, clips: tuple[Clip, ...], target: Group, colors: Colors) -> None:
        """Adds all items to a group; the matrix leads from the document's units to the tree's."""
        sources = self.sources
        size = (self.page.view.width, self.page.view.height)
        root = sources.document.root
        sources.waiting.append((root, Context(Style(), matrix, size, target, colors, clips)))
        count = 0
        while sources.waiting:
            element, context = sources.waiting.pop()
            count += 1
            if count % 100 == 0:
                # `use` may repeat more elements than the file has.
                self._report(0.5 + 0.5 * min(count / sources.document.count, 0.99))
            sources.budget.take_element()
            sources.schedule(self._visit(element, context))

    def _visit(self, element: SvgElement, context: Context) -> Iterator[tuple[SvgElement, Context]]:
        """Paints an element; yields its children."""
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
        inside = self._enter_effects(element, enter_element(element, context, sources))
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
                child_context = replace(inside, use=None)
                yield from ((child, child_context) for child in rendered_children(element))

    def _enter_effects(self, element: SvgElement, context: Context) -> Context | None:
        """Applies opacity, filters, masks and clip path; returns None if nothing is visible."""
        style, sources = context.style, self.sources
        if abs(determinant(context.matrix)) < _SMALLEST_DETERMINANT or style.opacity == 0.0:
            return None
        declared = sources.sheets.declared(element)
        for name in declared.keys() & UNSUPPORTED.keys():
            if declared[name].lower() not in UNSUPPORTED[name]:
                sources.warnings.unsupported(name, "ignored", element.line)
        inside = apply_clip_path(element, context, sources)
        filters = read_filters(element, context, sources, self._images)
        masks = read_masks(element, context, sources)
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
            self._paint_outline(element, context, _Paintable(outline, box, box))

    def _paint_text(self, element: SvgElement, context: Context) -> None:
        # Font modules load slowly, and drawings without text do not need them.
        from ..text.color_glyphs import ColoredPiece, draw_colored
        from ..text.text_elements import lay_out_text

        drawn = lay_out_text(element, context, self.sources)
        for piece in drawn.pieces:
            if isinstance(piece, ColoredPiece):
                draw_colored(piece, context, self.sources)
                continue
            piece_context = replace(context, style=piece.style)
            outline = _Paintable(piece.outline, piece.box, drawn.bounds)
            self._paint_outline(piece.element, piece_context, outline)

    def _paint_outline(self, element: SvgElement, context: Context, drawn: _Paintable) -> None:
        style, outline = context.style, drawn.outline
        stroke = resolve_stroke(element, context, outline, self.sources)
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
        drawn: _Paintable,
        paint: Paint,
        opacity: float,
        stroke: Stroke | None,
    ) -> None:
        resolved = resolve_paint(element, context, drawn.bounds, paint, opacity, self.sources)
        if resolved is None:
            return
        if stroke is not None and self._is_unscaled(element):
            context, drawn, resolved = self._to_page(context, drawn, resolved)
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
        # In browsers, optimizeSpeed turns off antialiasing, too.
        is_crisp = element.tag != "text" and context.style.shape_rendering in (
            "crispedges",
            "optimizespeed",
        )
        self.sources.budget.take_segments(len(outline), stroke.dash_count if stroke else 0.0)
        rule = context.style.fill_rule
        matrix, clips = context.matrix, context.clips
        context.target.items.append(
            Painted(outline, rule, matrix, resolved, stroke, clips, box, element.line, is_crisp)
        )

    def _is_unscaled(self, element: SvgElement) -> bool:
        """Returns whether the stroke width is in pixels of the page, whatever the transform."""
        vector_effect = self.sources.sheets.declared(element).get("vector-effect", "none")
        return vector_effect.strip().lower() == "non-scaling-stroke"

    def _to_page(
        self,
        context: Context,
        drawn: _Paintable,
        paint: tuple[float, ...] | Gradient | Pattern,
    ) -> tuple[Context, _Paintable, tuple[float, ...] | Gradient | Pattern]:
        """Converts an outline and its paint to pixels of the page."""
        page = self.page
        to_page = fit_view_box(page.view, page.aspect, page.width, page.height)
        own = compose(to_page, context.matrix)
        outline = drawn.outline.transformed(own)
        if not isinstance(paint, tuple):
            paint = replace(paint, matrix=compose(own, paint.matrix))
        box = outline.bounds() or drawn.box
        context = replace(context, matrix=inverse(to_page))
        return context, _Paintable(outline, box, drawn.bounds), paint

    def _read_nested(self, data: bytes, name: str) -> "TreeBuilder":
        """Reads a nested drawing, which may not refer to files."""
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
