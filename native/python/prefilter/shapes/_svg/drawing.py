# SPDX-License-Identifier: GPL-3.0-or-later

"""From elements to what is painted, in the order in which it is."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ... import _native
from ..shape import Shape
from .basic_shapes import BASIC_SHAPES, read_shape
from .document import Document, SvgElement
from .groups import Box, Groups, carried
from .lengths import Units, read_length
from .outline import Outline
from .paint_servers import GRADIENTS, Colors, Gradient, PaintServers
from .styles import UNSUPPORTED, Style, StyleSheets
from .values import (
    IDENTITY,
    Color,
    Length,
    Matrix,
    Paint,
    as_paint,
    as_transform,
    determinant,
    multiplied,
)
from .viewports import MOST_UNITS, ViewBox, as_view_box, placed
from .warnings import Warnings

MOST_USED = 250_000
_MOST_DASHES = 100_000
# In widths or heights of the drawing. No shape may be more than 1e9 pixels away.
_LARGEST = 1e5
_SMALLEST_DETERMINANT = 1e-40

_ZERO, _WHOLE = Length(0.0), Length(100.0, "%")
_OTHER_PAINTS = ("pattern", "hatch", "meshgradient", "solidcolor")
_GROUPS = ("g", "a", "svg", "symbol", "switch")
_NOT_DRAWN = frozenset(
    (
        *("defs", "marker", "clipPath", "mask", "filter", *GRADIENTS),
        *("title", "desc", "metadata", "style", "script", "view", "cursor"),
        *("animate", "animateColor", "animateMotion", "animateTransform", "set"),
        *("font", "font-face", "color-profile", *_OTHER_PAINTS),
    )
)


@dataclass(frozen=True, slots=True)
class Stroke:
    """How an outline is stroked, in its own units."""

    width: float
    cap: str
    join: str
    miter_limit: float
    dashes: tuple[float, ...]
    dash_offset: float


@dataclass(frozen=True, slots=True)
class Painted:
    """An outline to fill or to stroke.

    Attributes:
        outline: In its own units.
        fill_rule: For what it fills.
        matrix: From its units to those of the drawing.
        paint: A color, multiplied by its alpha, or a gradient in the outline's units.
        stroke: None where it is filled.
    """

    outline: Outline
    fill_rule: str
    matrix: Matrix
    paint: tuple[float, ...] | Gradient
    stroke: Stroke | None

    def shape(self, matrix: Matrix, tolerance: float) -> Shape:
        """In pixels, to which `matrix` leads from the drawing's units.

        `tolerance` is how far a stroke may be off, in pixels.
        """
        whole = multiplied(matrix, self.matrix)
        shape = self.outline.shape(self.fill_rule)
        if self.stroke is not None:
            scale = max(_native.hypot(*whole[:2]), _native.hypot(*whole[2:4]))
            shape = shape.stroked(
                self.stroke.width,
                join=self.stroke.join,
                cap=self.stroke.cap,
                miter_limit=self.stroke.miter_limit,
                dashes=self.stroke.dashes,
                dash_offset=self.stroke.dash_offset,
                tolerance=tolerance / scale,
            )
        a, b, c, d, e, f = whole
        shape = shape.transformed(np.array([[a, c, e], [b, d, f]]))
        if isinstance(self.paint, Gradient):
            self.paint.apply(shape, whole)
        else:
            shape.color = self.paint
        return shape


@dataclass(frozen=True, slots=True)
class _Context:
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
        self._warnings = warnings
        self._document = document
        self._colors = colors
        self._tell = tell
        self._sheets = StyleSheets(document, warnings, lambda share: tell(0.5 * share))
        self._servers = PaintServers(document, self._sheets, colors, warnings)
        self._outlines: dict[tuple[SvgElement, Units], Outline | None] = {}
        self.painted: list[Painted] = []
        self._read_size()
        view = self._view
        box = (view.x, view.y, view.x + view.width, view.y + view.height)
        self._groups = Groups(box, warnings)
        self._draw()
        self._groups.check()

    def placement(self, width: float, height: float) -> Matrix:
        """From the drawing's units to pixels of an image, with y upwards."""
        upwards = (1.0, 0.0, 0.0, -1.0, 0.0, height)
        return multiplied(upwards, placed(self._view, self._aspect, width, height))

    def _read_size(self) -> None:
        root = self._document.root
        declared = self._sheets.declared(root)
        view = as_view_box(declared.get("viewBox"))
        if view is None and "viewBox" in declared:
            self._warnings.broken("viewBox", "ignored", root.line)
        sizes = []
        for name in ("width", "height"):
            length = read_length(root, declared, name, self._warnings) or _WHOLE
            font_size = self._sheets.style(root).font_size
            pixels = length.pixels(1.0, font_size)
            if not 0.0 < pixels < MOST_UNITS:
                raise ValueError(
                    f"{self._document.name}, line {root.line}: {name} '{declared[name]}'; a "
                    f"drawing needs a positive one below {MOST_UNITS:g} pixels"
                )
            sizes.append(None if length.unit == "%" else pixels)
        width, height = sizes
        # What a file does not say follows from its view box, and without one is CSS's 300 x 150.
        if view is not None:
            if width is None:
                width = view.width if height is None else height * view.width / view.height
            height = width * view.height / view.width if height is None else height
        self.width, self.height = width or 300.0, height or 150.0
        self._view = view or ViewBox(0.0, 0.0, self.width, self.height)
        self._aspect = declared.get("preserveAspectRatio", "")

    def _draw(self) -> None:
        root = self._document.root
        context = _Context(Style(), IDENTITY, (self._view.width, self._view.height))
        # The next one is the last.
        waiting: list[tuple[SvgElement, _Context]] = [(root, context)]
        count = 0
        while waiting:
            element, context = waiting.pop()
            count += 1
            if count % 100 == 0:
                # With `use` there may be more than there are elements.
                self._tell(0.5 + 0.5 * min(count / self._document.count, 0.99))
            if count > MOST_USED + self._document.count:
                raise ValueError(
                    f"{self._document.name}: <use> repeats more than {MOST_USED} elements"
                )
            waiting.extend(reversed(list(self._visit(element, context))))

    def _visit(
        self, element: SvgElement, context: _Context
    ) -> Iterator[tuple[SvgElement, _Context]]:
        """Paints an element; yields those in it."""
        tag, declared = element.tag, self._sheets.declared(element)
        if tag in _NOT_DRAWN or tag.startswith("{") or declared.get("display", "") == "none":
            return
        if tag == "symbol" and context.use is None:
            return
        if tag not in _GROUPS and tag not in BASIC_SHAPES and tag != "use":
            self._warnings.unsupported(f"<{tag}>", "left out", element.line)
            return
        style = self._sheets.style_below(element, context.style)
        matrix = as_transform(declared.get("transform", ""))
        if matrix is None:
            self._warnings.broken("transform", "ignored", element.line)
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
        context = self._clipped(element, declared, context)
        for name in declared.keys() & UNSUPPORTED.keys():
            if declared[name].lower() not in UNSUPPORTED[name]:
                self._warnings.unsupported(name, "ignored", element.line)
        if tag in BASIC_SHAPES:
            self._paint(element, context)
            return
        if tag == "use":
            yield from self._used(element, context)
            return
        if tag in ("svg", "symbol") and element is not self._document.root:
            inner = self._viewport(element, declared, context)
            if inner is None:
                return
            context = inner
        context = replace(context, use=None)
        yield from ((child, context) for child in self._children(element))

    def _clipped(
        self, element: SvgElement, declared: Mapping[str, str], context: _Context
    ) -> _Context:
        """The context within a clip path, if the element has one."""
        text = declared.get("clip-path", "none")
        if text.lower() == "none":
            return context
        paint = as_paint(text)
        path = self._document.ids.get(paint.server[1:]) if paint and paint.server else None
        region = None
        if path is None and paint and paint.server.startswith("#"):
            self._warnings.broken("clip-path", "ignored", element.line)
            return context
        if path is not None and path.tag == "clipPath":
            region = self._region(path, context)
        number = self._groups.add_clipped(element, "clip-path", region)
        return replace(context, groups=(*context.groups, number))

    def _region(self, path: SvgElement, context: _Context) -> Box | None:
        """The box that a clip path is; None where it is something else."""
        shapes = [child for child in path if child.tag not in _NOT_DRAWN]
        target = shapes[0] if len(shapes) == 1 else None
        matrix: Matrix | None = context.matrix
        for each in (path, target):
            if isinstance(each, SvgElement) and matrix is not None:
                declared = self._sheets.declared(each)
                own = as_transform(declared.get("transform", ""))
                matrix = multiplied(matrix, own) if own else None
        if isinstance(target, SvgElement) and target.tag == "use":
            if "x" in target.attrib or "y" in target.attrib:
                return None
            target = self._document.ids.get(target.href)
            if target is not None and "transform" in self._sheets.declared(target):
                return None
        if not isinstance(target, SvgElement) or target.tag not in BASIC_SHAPES or matrix is None:
            return None
        if path.get("clipPathUnits", "userSpaceOnUse") != "userSpaceOnUse":
            return None
        declared = self._sheets.declared(target)
        is_upright = matrix[1] == matrix[2] == 0.0 or matrix[0] == matrix[3] == 0.0
        outline = read_shape(target, declared, context.units, self._warnings)
        if outline is None or not is_upright or not outline.is_box() or "clip-path" in declared:
            return None
        box = outline.bounds()
        return carried(box, matrix) if box else None

    def _children(self, element: SvgElement) -> Iterator[SvgElement]:
        for child in element:
            assert isinstance(child, SvgElement)
            if element.tag != "switch":
                yield child
            elif "requiredExtensions" not in child.attrib and not child.tag.startswith("{"):
                languages = child.attrib.get("systemLanguage", "en").split(",")
                if any(name.strip().lower().startswith("en") for name in languages):
                    yield child
                    return

    def _used(
        self, element: SvgElement, context: _Context
    ) -> Iterator[tuple[SvgElement, _Context]]:
        target = self._document.ids.get(element.href)
        if target is None:
            self._warnings.broken(
                "<use>", "left out, as what it refers to is not there", element.line
            )
            return
        if target in context.uses or target in _ancestors(element):
            self._warnings.broken("<use>", "left out, as it is inside of itself", element.line)
            return
        x = self._pixels(element, "x", _ZERO, context.units)
        y = self._pixels(element, "y", _ZERO, context.units)
        context = replace(
            context,
            matrix=multiplied(context.matrix, (1.0, 0.0, 0.0, 1.0, x, y)),
            uses=(*context.uses, target),
            use=element,
        )
        yield target, context

    def _viewport(
        self, element: SvgElement, declared: Mapping[str, str], context: _Context
    ) -> _Context | None:
        """The context inside of an `svg` or `symbol`; None where nothing shows."""
        sizes = []
        for name in ("width", "height"):
            source = element
            if context.use is not None and name in self._sheets.declared(context.use):
                source = context.use
            sizes.append(self._pixels(source, name, _WHOLE, context.units))
        x = y = 0.0
        if element.tag == "svg":
            x = self._pixels(element, "x", _ZERO, context.units)
            y = self._pixels(element, "y", _ZERO, context.units)
        width, height = sizes
        if width <= 0.0 or height <= 0.0:
            return None
        matrix = (1.0, 0.0, 0.0, 1.0, x, y)
        viewport = (width, height)
        groups = context.groups
        if declared.get("overflow", "hidden") not in ("visible", "auto"):
            region = carried((x, y, x + width, y + height), context.matrix)
            groups = (*groups, self._groups.add_clipped(element, "overflow", region))
        view = as_view_box(declared.get("viewBox"))
        if view is not None:
            fitted = placed(view, declared.get("preserveAspectRatio", ""), width, height)
            matrix = multiplied(matrix, fitted)
            viewport = (view.width, view.height)
        matrix = multiplied(context.matrix, matrix)
        return replace(context, matrix=matrix, viewport=viewport, groups=groups)

    def _paint(self, element: SvgElement, context: _Context) -> None:
        style = context.style
        if style.visibility != "visible":
            return
        key = (element, context.units)
        if key not in self._outlines:
            declared = self._sheets.declared(element)
            self._outlines[key] = read_shape(element, declared, context.units, self._warnings)
        outline = self._outlines[key]
        if outline is None:
            return
        stroke = self._stroke(element, context, outline)
        for part in _paint_order(style.paint_order):
            if part == "fill" and element.tag != "line":
                self._add(element, context, outline, style.fill, style.fill_opacity, None)
            elif part == "stroke" and stroke is not None:
                self._add(element, context, outline, style.stroke, style.stroke_opacity, stroke)

    def _add(
        self,
        element: SvgElement,
        context: _Context,
        outline: Outline,
        paint: Paint,
        opacity: float,
        stroke: Stroke | None,
    ) -> None:
        resolved = self._resolved(element, context, outline, paint, opacity * context.opacity)
        if resolved is None:
            return
        rule = context.style.fill_rule
        painted = Painted(outline, rule, context.matrix, resolved, stroke)
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
            abs(value) < _LARGEST * max(self._view.width, self._view.height) for value in box
        ):
            self._warnings.broken(
                f"<{element.tag}>", "left out, as it is too far away", element.line
            )
            return
        self.painted.append(painted)
        self._groups.put(context.groups, box)

    def _resolved(
        self, element: SvgElement, context: _Context, outline: Outline, paint: Paint, opacity: float
    ) -> tuple[float, ...] | Gradient | None:
        """What to paint with; None for nothing."""
        found: Gradient | Color | None = None
        is_here = paint.server.startswith("#")
        server = self._document.ids.get(paint.server[1:]) if is_here else None
        if server is not None and server.tag in GRADIENTS:
            bounds = outline.bounds()
            found = self._servers.resolve(server, opacity, context.units, bounds)
        elif server is not None:
            is_paint = server.tag in _OTHER_PAINTS
            tell = self._warnings.unsupported if is_paint else self._warnings.broken
            tell(f"<{server.tag}> as paint", "left out", element.line)
        elif paint.server:
            self._warnings.broken(f"url({paint.server[:60]})", "not there", element.line)
        if isinstance(found, Gradient):
            return found
        if found is None:
            color = context.style.color if isinstance(paint.color, str) else paint.color
            if color is None:
                return None
            found = (*color[:3], color[3] * opacity)
        if found[3] == 0.0:
            return None
        return self._colors.premultiplied(np.array([found]))[0]

    def _stroke(self, element: SvgElement, context: _Context, outline: Outline) -> Stroke | None:
        style = context.style
        if style.stroke.color is None and not style.stroke.server:
            return None
        units = context.units
        width = units.pixels(style.stroke_width, "stroke-width")
        if width <= 0.0:
            return None
        join = style.stroke_linejoin
        if join in ("miter-clip", "arcs"):
            self._warnings.unsupported(f"stroke-linejoin '{join}'", "drawn as miter", element.line)
            join = "miter"
        dashes = [units.pixels(length, "stroke-dasharray") for length in style.stroke_dasharray]
        if sum(dashes) <= 0.0:
            dashes = []
        elif outline.length() * len(dashes) > _MOST_DASHES * sum(dashes):
            self._warnings.broken("stroke-dasharray", "ignored: too many dashes", element.line)
            dashes = []
        elif "pathLength" in self._sheets.declared(element):
            self._warnings.unsupported("pathLength", "ignored", element.line)
        if len(dashes) % 2:
            dashes += dashes
        return Stroke(
            width,
            style.stroke_linecap,
            join,
            style.stroke_miterlimit,
            tuple(dashes),
            units.pixels(style.stroke_dashoffset, "stroke-dashoffset"),
        )

    def _pixels(self, element: SvgElement, name: str, default: Length, units: Units) -> float:
        declared = self._sheets.declared(element)
        length = read_length(element, declared, name, self._warnings)
        return units.pixels(default if length is None else length, name)


def _ancestors(element: SvgElement) -> Iterator[SvgElement]:
    at: SvgElement | None = element
    while at is not None:
        yield at
        at = at.parent


def _paint_order(text: str) -> tuple[str, str]:
    named = [name for name in text.split() if name in ("fill", "stroke")]
    return ("stroke", "fill") if named[:1] == ["stroke"] else ("fill", "stroke")
