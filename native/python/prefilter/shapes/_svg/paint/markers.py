# SPDX-License-Identifier: GPL-3.0-or-later

"""Markers at the vertices of paths and lines."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from .... import _native
from ...affine import IDENTITY, Matrix, compose, translation
from ..model.calculations import DEGREES
from ..model.outline import Outline
from ..model.tree import Group, make_box_clip
from ..model.values import Length, parse_number, rotation
from ..model.view_boxes import fit_view_box, parse_view_box
from ..read.context import Context, Sources, context_paints
from ..read.document import SvgElement
from ..read.nesting import VISIBLE_OVERFLOW, rendered_children

MARKED = ("path", "line", "polyline", "polygon")
_ZERO, _THREE = Length(0.0), Length(3.0)
_REFERENCE_FRACTIONS = {"left": 0.0, "top": 0.0, "center": 0.5, "right": 1.0, "bottom": 1.0}
_Direction = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Vertex:
    """A vertex of an outline.

    Attributes:
        before: Direction in which the outline arrives; None at a start.
        after: Direction in which it leaves; None at an end.
    """

    x: float
    y: float
    before: _Direction | None
    after: _Direction | None

    @property
    def angle(self) -> float:
        """Angle of the bisector, in degrees."""
        before, after = self.before or self.after, self.after or self.before
        if before is None or after is None:
            return 0.0
        x, y = before[0] + after[0], before[1] + after[1]
        if x == y == 0.0:
            x, y = -before[1], before[0]
        return math.degrees(_native.atan2(y, x))


def draw_markers(element: SvgElement, context: Context, outline: Outline, sources: Sources) -> None:
    """Draws the markers of an outline."""
    style = context.style
    markers = {
        name: _marker(text, element, context, sources)
        for name, text in (
            ("start", style.marker_start),
            ("mid", style.marker_mid),
            ("end", style.marker_end),
        )
    }
    if all(marker is None for marker in markers.values()):
        return
    vertices = list(outline_vertices(outline))
    context = replace(context, paints=context_paints(element, context))
    for index, vertex in enumerate(vertices):
        at_start, at_end = index == 0, index == len(vertices) - 1
        for name, is_there in (
            ("start", at_start),
            ("mid", not at_start and not at_end),
            ("end", at_end),
        ):
            marker = markers[name]
            if is_there and marker is not None:
                _draw(marker, vertex, name == "start", context, sources)


def _marker(
    text: str, element: SvgElement, context: Context, sources: Sources
) -> SvgElement | None:
    if text.lower() == "none":
        return None
    marker = sources.resolve_url(text)
    if marker is None or marker.tag != "marker":
        sources.warnings.broken("marker", "left out", element.line)
        return None
    if marker in context.uses:
        sources.warnings.broken("marker", "left out, as it is inside of itself", element.line)
        return None
    return marker


def _draw(
    marker: SvgElement, vertex: Vertex, is_start: bool, context: Context, sources: Sources
) -> None:
    declared = sources.sheets.declared(marker)
    style = sources.sheets.style(marker)
    marker_context = replace(context, style=style)
    width, height = (
        sources.pixels(marker, name, _THREE, marker_context.units)
        for name in ("markerWidth", "markerHeight")
    )
    if width <= 0.0 or height <= 0.0:
        return
    orient = declared.get("orient", "0").strip()
    angle = vertex.angle if orient.startswith("auto") else _degrees(orient)
    if orient == "auto-start-reverse" and is_start:
        angle += 180.0
    matrix = compose(translation(vertex.x, vertex.y), rotation(angle))
    if declared.get("markerUnits", "strokeWidth") != "userSpaceOnUse":
        scale = context.units.pixels(context.style.stroke_width, "stroke-width")
        matrix = compose(matrix, (scale, 0.0, 0.0, scale, 0.0, 0.0))
    fitted: Matrix = IDENTITY
    size = (width, height)
    region = (0.0, 0.0, width, height)
    view = parse_view_box(declared.get("viewBox"))
    if view is not None:
        fitted = fit_view_box(view, declared.get("preserveAspectRatio", ""), width, height)
        size = (view.width, view.height)
    ref_x, ref_y = (
        _REFERENCE_FRACTIONS[declared[name]] * side
        if declared.get(name) in _REFERENCE_FRACTIONS
        else sources.pixels(marker, name, _ZERO, marker_context.units)
        for name, side in (("refX", size[0]), ("refY", size[1]))
    )
    a, b, c, d = fitted[:4]
    reference = (a * ref_x + c * ref_y + fitted[4], b * ref_x + d * ref_y + fitted[5])
    matrix = compose(matrix, translation(-reference[0], -reference[1]))
    to_tree = compose(context.matrix, matrix)
    clips = context.clips
    if declared.get("overflow", "hidden") not in VISIBLE_OVERFLOW:
        clips = (*clips, make_box_clip(region, to_tree))
    group = Group(line=marker.line)
    context.target.items.append(group)
    inside = replace(
        marker_context,
        matrix=compose(to_tree, fitted),
        viewport=size,
        target=group,
        clips=clips,
        uses=(*context.uses, marker),
        use=None,
    )
    sources.schedule((child, inside) for child in rendered_children(marker))


def _degrees(text: str) -> float:
    for name, scale in DEGREES.items():
        if text.endswith(name):
            return (parse_number(text.removesuffix(name)) or 0.0) * scale
    return parse_number(text) or 0.0


def outline_vertices(outline: Outline) -> Iterator[Vertex]:
    """Yields the vertices of an outline, with the directions there."""
    points: list[tuple[float, float]] = []
    # Directions in which the outline leaves and reaches each point.
    leaving: list[_Direction | None] = []
    reaching: list[_Direction | None] = []
    current = begin = (0.0, 0.0)
    first = 0
    for kind, numbers in outline.segments():
        if kind == "M":
            current = begin = (numbers[0], numbers[1])
            first = len(points)
            points.append(current)
            leaving.append(None)
            reaching.append(None)
            continue
        end = begin if kind == "Z" else (numbers[-2], numbers[-1])
        inner = numbers[:2] if kind == "W" else numbers[:-2]
        controls = [current, *zip(inner[::2], inner[1::2], strict=True), end]
        if kind == "Z" and end == current and len(points) > first + 1:
            # The contour already ends at its start: merge the directions of both.
            reaching[first], leaving[-1] = reaching[-1], leaving[first]
            continue
        leaving[-1] = _direction(controls)
        back = _direction(controls[::-1])
        points.append(end)
        leaving.append(None)
        reaching.append((-back[0], -back[1]) if back else None)
        if kind == "Z":
            reaching[first], leaving[-1] = reaching[-1], leaving[first]
        current = end
    for (x, y), before, after in zip(points, reaching, leaving, strict=True):
        yield Vertex(x, y, before, after)


def _direction(controls: list[tuple[float, float]]) -> _Direction | None:
    """Returns the unit direction at the first point of a curve; None if it has no length."""
    x, y = controls[0]
    for other_x, other_y in controls[1:]:
        length = _native.hypot(other_x - x, other_y - y)
        if length > 0.0:
            return (other_x - x) / length, (other_y - y) / length
    return None
