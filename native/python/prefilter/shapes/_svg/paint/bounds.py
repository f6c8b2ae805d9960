# SPDX-License-Identifier: GPL-3.0-or-later

"""The box around an element, which units called objectBoundingBox are shares of."""

from dataclasses import replace

from ...affine import IDENTITY
from ..model.tree import Box, transform_box, unite_boxes
from ..model.values import Length
from ..read.basic_shapes import BASIC_SHAPES
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.nesting import enter_element, enter_viewport, rendered_children, resolve_use
from ..read.tags import GROUPS, NOT_DRAWN

_ZERO = Length(0.0)


def object_bounds(element: SvgElement, context: Context, sources: Sources) -> Box | None:
    """The box around what an element fills, in its own units; None where it fills nothing.

    Args:
        element: The element.
        context: Within it.
        sources: What it is read with.
    """
    waiting = [(element, replace(context, matrix=IDENTITY))]
    found: Box | None = None
    while waiting:
        sources.budget.take_measured()
        each, place = waiting.pop()
        found = unite_boxes(found, _own_bounds(each, place, sources))
        waiting.extend(_inner(each, place, sources, is_outermost=each is element))
    return found


def _own_bounds(element: SvgElement, context: Context, sources: Sources) -> Box | None:
    if element.tag in BASIC_SHAPES:
        outline = sources.outline(element, context.units)
        box = outline.bounds() if outline is not None else None
        return transform_box(box, context.matrix) if box is not None else None
    if element.tag == "text":
        # Fonts take modules that those who draw no text need not wait for.
        from ..text.text_elements import drawn_text

        box = drawn_text(element, context, sources).bounds
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
    """The elements in another one, each in its own units."""
    if element.tag == "use":
        inside = list(resolve_use(element, context, sources))
    elif element.tag in GROUPS:
        place: Context | None = context
        if element.tag in ("svg", "symbol") and not is_outermost:
            place = enter_viewport(element, context, sources)
        if place is None:
            return []
        inside = [(child, replace(place, use=None)) for child in rendered_children(element)]
    else:
        return []
    return [
        (child, enter_element(child, place, sources))
        for child, place in inside
        if child.tag not in NOT_DRAWN and sources.sheets.declared(child).get("display") != "none"
    ]
