# SPDX-License-Identifier: GPL-3.0-or-later

"""Masks: what is seen of an element follows from the luminance or alpha of others."""

from dataclasses import replace

from ...affine import Matrix, multiplied
from ..model.clips import make_box_clip
from ..model.gradients import Colors
from ..model.tree import Box, Group, Mask
from ..model.values import Length
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.lengths import Units
from ..read.nesting import rendered_children
from .bounds import object_bounds

_DEFAULTS = {"x": -10.0, "y": -10.0, "width": 120.0, "height": 120.0}


def masks_of(element: SvgElement, context: Context, sources: Sources) -> tuple[Mask, ...] | None:
    """The masks of an element; None where they let nothing through.

    `context` is that within the element. As in browsers a mask has no mask itself; elements in it
    may have some. A reference that closes a circle is ignored from then on.
    """
    text = sources.sheets.declared(element).get("mask", "none")
    if text.lower() == "none":
        return ()
    mask = sources.resolve_url(text)
    if mask is None or mask.tag != "mask":
        sources.warnings.broken("mask", "ignored", element.line)
        return ()
    if mask in context.uses and element not in sources.circular:
        sources.circular.add(element)
        sources.warnings.broken("mask", "ignored, as it refers to itself", element.line)
    if element in sources.circular:
        return ()
    box = object_bounds(element, context, sources)
    region, matrix = box_in_units(mask, "maskUnits", _DEFAULTS, box, context, sources)
    if region is None:
        return None
    style = sources.sheets.style(mask)
    group = Group(is_isolated=True, line=mask.line)
    clips = (*context.clips, make_box_clip(region, multiplied(context.matrix, matrix)))
    # Masks are as bright as they look.
    place = replace(
        context,
        style=style,
        target=group,
        colors=Colors(style.color_interpolation == "linearrgb", context.colors.is_stepped),
        clips=clips,
        uses=(*context.uses, mask),
        use=None,
    )
    if mask.get("maskContentUnits") == "objectBoundingBox":
        shares = shares_of(box)
        if shares is None:
            return None
        place = replace(place, matrix=multiplied(context.matrix, shares), viewport=(1.0, 1.0))
    sources.schedule((child, place) for child in rendered_children(mask))
    return (Mask(group, style.mask_type == "luminance", place.colors.is_linear),)


def shares_of(box: Box | None) -> Matrix | None:
    """From shares of a box to its units; None where it has no area."""
    if box is None or box[2] <= box[0] or box[3] <= box[1]:
        return None
    return (box[2] - box[0], 0.0, 0.0, box[3] - box[1], box[0], box[1])


def box_in_units(
    element: SvgElement,
    name: str,
    defaults: dict[str, float],
    box: Box | None,
    context: Context,
    sources: Sources,
) -> tuple[Box | None, Matrix]:
    """The region that x, y, width and height of an element make, and what its units are.

    Args:
        element: The element.
        name: Of the attribute that says what the units are; by default shares of a box.
        defaults: Of the four, in percent.
        box: The box.
        context: Of what refers to the element.
        sources: What it is read with.
    """
    is_share = element.get(name, "objectBoundingBox") != "userSpaceOnUse"
    matrix = shares_of(box) if is_share else (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    if matrix is None:
        return None, (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    units = Units(1.0, 1.0, context.style.font_size) if is_share else context.units
    x, y, width, height = (
        sources.pixels(element, key, Length(value, "%"), units) for key, value in defaults.items()
    )
    if width <= 0.0 or height <= 0.0:
        return None, matrix
    return (x, y, x + width, y + height), matrix
