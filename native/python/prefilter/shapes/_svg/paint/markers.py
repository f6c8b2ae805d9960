# SPDX-License-Identifier: GPL-3.0-or-later

"""Markers: symbols at the corners of paths and lines."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from .... import _native
from ...affine import IDENTITY, Matrix, multiplied
from ..model.clips import make_box_clip
from ..model.outline import Outline
from ..model.tree import Group
from ..model.values import Length, parse_number, rotation
from ..model.view_boxes import fit_view_box, parse_view_box
from ..read.context import Context, Sources, context_paints
from ..read.document import SvgElement
from ..read.nesting import VISIBLE_OVERFLOW, rendered_children

MARKED = ("path", "line", "polyline", "polygon")
_ZERO, _THREE = Length(0.0), Length(3.0)
_PLACES = {"left": 0.0, "top": 0.0, "center": 0.5, "right": 1.0, "bottom": 1.0}
_Direction = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Corner:
    """A point between two segments, or at an end.

    Attributes:
        before: The direction in which the outline comes there; None where it begins.
        after: That in which it goes on; None where it ends.
    """

    x: float
    y: float
    before: _Direction | None
    after: _Direction | None

    @property
    def angle(self) -> float:
        """Of the bisector, in degrees."""
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
    found = {
        name: _marker(text, element, context, sources)
        for name, text in (
            ("start", style.marker_start),
            ("mid", style.marker_mid),
            ("end", style.marker_end),
        )
    }
    if all(marker is None for marker in found.values()):
        return
    corners = list(corners_of(outline))
    context = replace(context, paints=context_paints(element, context))
    for index, corner in enumerate(corners):
        at_start, at_end = index == 0, index == len(corners) - 1
        for name, is_there in (
            ("start", at_start),
            ("mid", not at_start and not at_end),
            ("end", at_end),
        ):
            marker = found[name]
            if is_there and marker is not None:
                _draw(marker, corner, name == "start", context, sources)


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
    marker: SvgElement, corner: Corner, is_start: bool, context: Context, sources: Sources
) -> None:
    declared = sources.sheets.declared(marker)
    style = sources.sheets.style(marker)
    place = replace(context, style=style)
    width, height = (
        sources.pixels(marker, name, _THREE, place.units)
        for name in ("markerWidth", "markerHeight")
    )
    if width <= 0.0 or height <= 0.0:
        return
    orient = declared.get("orient", "0").strip()
    angle = corner.angle if orient.startswith("auto") else _degrees(orient)
    if orient == "auto-start-reverse" and is_start:
        angle += 180.0
    matrix = multiplied((1.0, 0.0, 0.0, 1.0, corner.x, corner.y), rotation(angle))
    if declared.get("markerUnits", "strokeWidth") != "userSpaceOnUse":
        scale = context.units.pixels(context.style.stroke_width, "stroke-width")
        matrix = multiplied(matrix, (scale, 0.0, 0.0, scale, 0.0, 0.0))
    fitted: Matrix = IDENTITY
    size = (width, height)
    region = (0.0, 0.0, width, height)
    view = parse_view_box(declared.get("viewBox"))
    if view is not None:
        fitted = fit_view_box(view, declared.get("preserveAspectRatio", ""), width, height)
        size = (view.width, view.height)
    ref_x, ref_y = (
        _PLACES[declared[name]] * side
        if declared.get(name) in _PLACES
        else sources.pixels(marker, name, _ZERO, place.units)
        for name, side in (("refX", size[0]), ("refY", size[1]))
    )
    a, b, c, d = fitted[:4]
    reference = (a * ref_x + c * ref_y + fitted[4], b * ref_x + d * ref_y + fitted[5])
    matrix = multiplied(matrix, (1.0, 0.0, 0.0, 1.0, -reference[0], -reference[1]))
    around = multiplied(context.matrix, matrix)
    clips = context.clips
    if declared.get("overflow", "hidden") not in VISIBLE_OVERFLOW:
        clips = (*clips, make_box_clip(region, around))
    group = Group(line=marker.line)
    context.target.items.append(group)
    inside = replace(
        place,
        matrix=multiplied(around, fitted),
        viewport=size,
        target=group,
        clips=clips,
        uses=(*context.uses, marker),
        use=None,
    )
    sources.schedule((child, inside) for child in rendered_children(marker))


def _degrees(text: str) -> float:
    units = {"deg": 1.0, "grad": 0.9, "rad": 180.0 / math.pi, "turn": 360.0}
    for name, scale in units.items():
        if text.endswith(name):
            return (parse_number(text.removesuffix(name)) or 0.0) * scale
    return parse_number(text) or 0.0


def corners_of(outline: Outline) -> Iterator[Corner]:
    """Yields the points of an outline at which markers are, with its directions there."""
    points: list[tuple[float, float]] = []
    # The direction in which each point is left and reached.
    leaving: list[_Direction | None] = []
    reaching: list[_Direction | None] = []
    at = begin = (0.0, 0.0)
    begun = 0
    for kind, numbers in outline.segments():
        if kind == "M":
            at = begin = (numbers[0], numbers[1])
            begun = len(points)
            points.append(at)
            leaving.append(None)
            reaching.append(None)
            continue
        end = begin if kind == "Z" else (numbers[-2], numbers[-1])
        inner = numbers[:2] if kind == "W" else numbers[:-2]
        controls = [at, *zip(inner[::2], inner[1::2], strict=True), end]
        if kind == "Z" and end == at and len(points) > begun + 1:
            # It is there already: where it begins and ends, directions are those of both.
            reaching[begun], leaving[-1] = reaching[-1], leaving[begun]
            continue
        leaving[-1] = _direction(controls)
        back = _direction(controls[::-1])
        points.append(end)
        leaving.append(None)
        reaching.append((-back[0], -back[1]) if back else None)
        if kind == "Z":
            reaching[begun], leaving[-1] = reaching[-1], leaving[begun]
        at = end
    for (x, y), before, after in zip(points, reaching, leaving, strict=True):
        yield Corner(x, y, before, after)


def _direction(controls: list[tuple[float, float]]) -> _Direction | None:
    """In which a curve leaves its first point, as a unit vector."""
    x, y = controls[0]
    for other_x, other_y in controls[1:]:
        length = _native.hypot(other_x - x, other_y - y)
        if length > 0.0:
            return (other_x - x) / length, (other_y - y) / length
    return None
