# SPDX-License-Identifier: GPL-3.0-or-later

"""Bounding boxes of elements: the objectBoundingBox of units."""

from dataclasses import replace

from ...affine import IDENTITY
from ..model.tree import Box, transform_box, unite_boxes
from ..model.values import Length
from ..read.basic_shapes import BASIC_SHAPES
from ..read.context import Context, Sources
from ..read.document import GROUPS, NOT_DRAWN, SvgElement
from ..read.nesting import enter_element, enter_viewport, rendered_children, resolve_use

_ZERO = Length(0.0)


def object_bounds(element: SvgElement, context: Context, sources: Sources) -> Box | None:
    """Returns the bounding box of an element's fill, in its own units; None if it is empty."""
    pending = [(element, replace(context, matrix=IDENTITY))]
    bounds: Box | None = None
    while pending:
        sources.budget.take_measured()
        each, inner_context = pending.pop()
        bounds = unite_boxes(bounds, _own_bounds(each, inner_context, sources))
        pending.extend(_inner(each, inner_context, sources, is_outermost=each is element))
    return bounds


def _own_bounds(element: SvgElement, context: Context, sources: Sources) -> Box | None:
    if element.tag in BASIC_SHAPES:
        outline = sources.outline(element, context.units)
        box = outline.bounds() if outline is not None else None
        return transform_box(box, context.matrix) if box is not None else None
    if element.tag == "text":
        # Font modules load slowly, and drawings without text do not need them.
        from ..text.text_elements import lay_out_text

        box = lay_out_text(element, context, sources).bounds
        return transform_box(box, context.matrix) if box is not None else None
    if element.tag == "image":
        x, y, width, height = (
            sources.pixels(element, name, _ZERO, context.units)
            for name in ("x", "y", "width", "height")
        )
        return transform_box((x, y, x + width, y + height), context.matrix)
    return None


def _inner(
    element: SvgElement, context: Context, sources: Sources, *, is_outermost: bool
) -> list[tuple[SvgElement, Context]]:
    """Returns an element's children, each with the context within it."""
    if element.tag == "use":
        inside = list(resolve_use(element, context, sources))
    elif element.tag in GROUPS:
        child_context: Context | None = context
        if element.tag in ("svg", "symbol") and not is_outermost:
            child_context = enter_viewport(element, context, sources)
        if child_context is None:
            return []
        inside = [(child, replace(child_context, use=None)) for child in rendered_children(element)]
    else:
        return []
    return [
        (child, enter_element(child, child_context, sources))
        for child, child_context in inside
        if child.tag not in NOT_DRAWN and sources.sheets.declared(child).get("display") != "none"
    ]
