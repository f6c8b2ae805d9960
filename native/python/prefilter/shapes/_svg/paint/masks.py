# SPDX-License-Identifier: GPL-3.0-or-later

"""Masks, by luminance or alpha."""

from dataclasses import replace

from ...affine import IDENTITY, Matrix, compose
from ..model.gradients import Colors
from ..model.tree import Box, Group, Mask, make_box_clip
from ..model.values import Length
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.lengths import Units
from ..read.nesting import rendered_children
from .bounds import object_bounds

_DEFAULTS = {"x": -10.0, "y": -10.0, "width": 120.0, "height": 120.0}


def read_masks(element: SvgElement, context: Context, sources: Sources) -> tuple[Mask, ...] | None:
    """Reads the masks of an element; returns None if they hide everything.

    `context` is that within the element. A mask itself has no mask, as in browsers, but elements in
    it may have some. A circular reference is ignored.
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
    region, matrix = read_region(mask, "maskUnits", _DEFAULTS, box, context, sources)
    if region is None:
        return None
    style = sources.sheets.style(mask)
    group = Group(is_isolated=True, line=mask.line)
    clips = (*context.clips, make_box_clip(region, compose(context.matrix, matrix)))
    # Luminance is that of the mask's own color interpolation.
    inside = replace(
        context,
        style=style,
        target=group,
        colors=Colors(style.color_interpolation == "linearrgb", context.colors.is_stepped),
        clips=clips,
        uses=(*context.uses, mask),
        use=None,
    )
    if mask.get("maskContentUnits") == "objectBoundingBox":
        to_box = fractions_to_box(box)
        if to_box is None:
            return None
        inside = replace(inside, matrix=compose(context.matrix, to_box), viewport=(1.0, 1.0))
    sources.schedule((child, inside) for child in rendered_children(mask))
    return (Mask(group, style.mask_type == "luminance", inside.colors.is_linear),)


def fractions_to_box(box: Box | None) -> Matrix | None:
    """Returns the matrix from fractions of a box to its units; None if the box has no area."""
    if box is None or box[2] <= box[0] or box[3] <= box[1]:
        return None
    return (box[2] - box[0], 0.0, 0.0, box[3] - box[1], box[0], box[1])


def read_region(
    element: SvgElement,
    name: str,
    defaults: dict[str, float],
    box: Box | None,
    context: Context,
    sources: Sources,
) -> tuple[Box | None, Matrix]:
    """Returns the region given by x, y, width and height of an element, and the matrix of its
    units.

    Args:
        name: Attribute that names the units; the default is fractions of `box`.
        defaults: Defaults of the four attributes, in percent.
        box: Bounding box of the element that refers to it.
        context: Context of the element that refers to it.
    """
    is_fraction = element.get(name, "objectBoundingBox") != "userSpaceOnUse"
    matrix = fractions_to_box(box) if is_fraction else IDENTITY
    if matrix is None:
        return None, IDENTITY
    units = Units(1.0, 1.0, context.style.font_size) if is_fraction else context.units
    x, y, width, height = (
        sources.pixels(element, key, Length(value, "%"), units) for key, value in defaults.items()
    )
    if width <= 0.0 or height <= 0.0:
        return None, matrix
    return (x, y, x + width, y + height), matrix
