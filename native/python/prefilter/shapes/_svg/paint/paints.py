# SPDX-License-Identifier: GPL-3.0-or-later

"""What an outline is filled and stroked with."""

from dataclasses import replace

import numpy as np

from ...affine import inverse, multiplied
from ..model.colors import Color
from ..model.gradients import Gradient
from ..model.outline import Outline
from ..model.tree import Box, Pattern, Stroke
from ..model.values import Paint
from ..read.context import Context, ContextPaint, Sources
from ..read.document import SvgElement
from ..read.tags import GRADIENTS, OTHER_PAINTS
from .bounds import object_bounds
from .masks import shares_of
from .patterns import pattern_of

_MAX_DASHES = 100_000


def resolved(
    element: SvgElement,
    context: Context,
    bounds: Box | None,
    paint: Paint,
    opacity: float,
    sources: Sources,
) -> tuple[float, ...] | Gradient | Pattern | None:
    """What to paint with; None for nothing."""
    if isinstance(paint.color, str) and paint.color in context.paints:
        held = context.paints[paint.color]
        if held.paint.server:
            return _resolved_there(held, context, opacity, sources)
        paint = held.paint
    found: Gradient | Color | None = None
    is_here = paint.server.startswith("#")
    server = sources.document.ids.get(paint.server[1:]) if is_here else None
    if server is not None and server.tag in GRADIENTS:
        if not sources.servers.has_colors(server):
            return None  # As in browsers: the color is for where there is no gradient.
        found = sources.servers.resolve(server, opacity, context.units, bounds, context.colors)
    elif server is not None and server.tag == "pattern":
        pattern = pattern_of(server, opacity, context, bounds, sources)
        # Shares of a box without an area are nothing, and the color is for that.
        if pattern is not None or shares_of(bounds) is not None:
            return pattern
    elif server is not None:
        is_paint = server.tag in OTHER_PAINTS
        report = sources.warnings.unsupported if is_paint else sources.warnings.broken
        report(f"<{server.tag}> as paint", "left out", element.line)
    elif paint.server:
        sources.warnings.broken(f"url({paint.server[:60]})", "not there", element.line)
    if isinstance(found, Gradient):
        return found
    if found is None:
        # What `context-fill` stands for is nothing where nothing refers to the element.
        color = context.style.color if paint.color == "current" else paint.color
        if color is None or isinstance(color, str):
            return None
        found = (*color[:3], context.colors.opacity(color[3] * opacity))
    if found[3] == 0.0:
        return None
    return context.colors.premultiplied(np.array([found]))[0]


def _resolved_there(
    held: ContextPaint, context: Context, opacity: float, sources: Sources
) -> tuple[float, ...] | Gradient | Pattern | None:
    """What another element is painted with, where that is, in units of this one."""
    there = replace(held.context, colors=context.colors)
    bounds = object_bounds(held.element, there, sources)
    found = resolved(held.element, there, bounds, held.paint, opacity, sources)
    if found is None or isinstance(found, tuple):
        return found
    to_here = multiplied(inverse(context.matrix), there.matrix)
    return replace(found, matrix=multiplied(to_here, found.matrix))


def stroke_of(
    element: SvgElement, context: Context, outline: Outline, sources: Sources
) -> Stroke | None:
    """How an outline is stroked; None where it is not."""
    style = context.style
    if style.stroke.color is None and not style.stroke.server:
        return None
    units = context.units
    width = units.pixels(style.stroke_width, "stroke-width")
    if width <= 0.0:
        return None
    join = style.stroke_linejoin
    if join in ("miter-clip", "arcs"):
        sources.warnings.unsupported(f"stroke-linejoin '{join}'", "drawn as miter", element.line)
        join = "miter"
    dashes = [units.pixels(length, "stroke-dasharray") for length in style.stroke_dasharray]
    count = outline.length() * len(dashes) / sum(dashes) if sum(dashes) > 0.0 else 0.0
    if count == 0.0:
        dashes = []
    elif count > _MAX_DASHES:
        sources.warnings.broken("stroke-dasharray", "ignored: too many dashes", element.line)
        dashes, count = [], 0.0
    elif "pathLength" in sources.sheets.declared(element):
        sources.warnings.unsupported("pathLength", "ignored", element.line)
    if len(dashes) % 2:
        dashes += dashes
    return Stroke(
        width,
        style.stroke_linecap,
        join,
        style.stroke_miterlimit,
        tuple(dashes),
        units.pixels(style.stroke_dashoffset, "stroke-dashoffset"),
        count,
    )


def paint_order(text: str) -> list[str]:
    """Fill, stroke and markers in the order that the property of that name says."""
    usual = ["fill", "stroke", "markers"]
    named = list(dict.fromkeys(text.split()))
    if not set(named) <= set(usual) or len(named) < len(text.split()):
        return usual
    return [*named, *(name for name in usual if name not in named)]
