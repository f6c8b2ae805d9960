# SPDX-License-Identifier: GPL-3.0-or-later

"""Fill and stroke of outlines."""

from dataclasses import replace

import numpy as np

from ...affine import compose, inverse
from ..model.colors import Color
from ..model.gradients import Gradient
from ..model.outline import Outline
from ..model.tree import Box, Pattern, Stroke
from ..model.values import Paint
from ..read.context import Context, ContextPaint, Sources
from ..read.document import GRADIENTS, OTHER_PAINTS, SvgElement
from .bounds import object_bounds
from .masks import fractions_to_box
from .patterns import read_pattern

_MAX_DASHES = 100_000


def resolve_paint(
    element: SvgElement,
    context: Context,
    bounds: Box | None,
    paint: Paint,
    opacity: float,
    sources: Sources,
) -> tuple[float, ...] | Gradient | Pattern | None:
    """Resolves a paint to a color, gradient or pattern; returns None if nothing is painted."""
    if isinstance(paint.color, str) and paint.color in context.paints:
        held = context.paints[paint.color]
        if held.paint.server:
            return _resolve_context_paint(held, context, opacity, sources)
        paint = held.paint
    gradient: Gradient | Color | None = None
    is_local = paint.server.startswith("#")
    server = sources.document.ids.get(paint.server[1:]) if is_local else None
    if server is not None and server.tag in GRADIENTS:
        if not sources.servers.has_colors(server):
            return None  # as in browsers, no fallback color
        gradient = sources.servers.resolve(server, opacity, context.units, bounds, context.colors)
    elif server is not None and server.tag == "pattern":
        pattern = read_pattern(server, opacity, context, bounds, sources)
        # An invalid pattern paints nothing, but a box without an area has the fallback color.
        if pattern is not None or fractions_to_box(bounds) is not None:
            return pattern
    elif server is not None:
        is_paint = server.tag in OTHER_PAINTS
        report = sources.warnings.unsupported if is_paint else sources.warnings.broken
        report(f"<{server.tag}> as paint", "left out", element.line)
    elif paint.server:
        sources.warnings.broken(f"url({paint.server[:60]})", "not there", element.line)
    if isinstance(gradient, Gradient):
        return gradient
    if gradient is None:
        # `context-fill` without a referring element is none.
        color = context.style.color if paint.color == "current" else paint.color
        if color is None or isinstance(color, str):
            return None
        gradient = (*color[:3], context.colors.opacity(color[3] * opacity))
    if gradient[3] == 0.0:
        return None
    return context.colors.premultiplied(np.array([gradient]))[0]


def _resolve_context_paint(
    held: ContextPaint, context: Context, opacity: float, sources: Sources
) -> tuple[float, ...] | Gradient | Pattern | None:
    """Resolves the paint of another element, and converts it to the units of this one."""
    owner_context = replace(held.context, colors=context.colors)
    bounds = object_bounds(held.element, owner_context, sources)
    paint = resolve_paint(held.element, owner_context, bounds, held.paint, opacity, sources)
    if paint is None or isinstance(paint, tuple):
        return paint
    to_here = compose(inverse(context.matrix), owner_context.matrix)
    return replace(paint, matrix=compose(to_here, paint.matrix))


def resolve_stroke(
    element: SvgElement, context: Context, outline: Outline, sources: Sources
) -> Stroke | None:
    """Resolves the stroke of an outline; returns None if there is none."""
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
    """Returns fill, stroke and markers in the order given by `paint-order`."""
    default = ["fill", "stroke", "markers"]
    named = list(dict.fromkeys(text.split()))
    if not set(named) <= set(default) or len(named) < len(text.split()):
        return default
    return [*named, *(name for name in default if name not in named)]
