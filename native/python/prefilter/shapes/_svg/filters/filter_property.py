# SPDX-License-Identifier: GPL-3.0-or-later

"""Reading of the property `filter`, and of `filter` elements."""

from dataclasses import replace

from ...affine import IDENTITY, compose, translation
from ..model.tree import Box, Filter, Group, Step, transform_box
from ..model.values import Length
from ..paint.bounds import object_bounds
from ..paint.images import Images, place_image
from ..paint.masks import fractions_to_box, read_region
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.lengths import Units
from ..read.nesting import ancestors
from ..read.styles import Style
from .functions import InvalidFunctionError, filter_by_function, parse_filter_list
from .primitives import PRIMITIVE_READERS, FilterUnits, UnsupportedPrimitiveError

# Products of larger numbers could overflow float32.
_LARGEST = 1e9
# Inputs that no browser supports; browsers treat them as missing.
_UNSUPPORTED_INPUTS = ("BackgroundImage", "BackgroundAlpha", "FillPaint", "StrokePaint")
_EMPTY_BOX = (0.0, 0.0, 0.0, 0.0)
_DEFAULTS = {"x": -10.0, "y": -10.0, "width": 120.0, "height": 120.0}


def read_filters(
    element: SvgElement, context: Context, sources: Sources, images: Images
) -> tuple[Filter, ...]:
    """Reads an element's filters in the order of application; none if one is invalid.

    `context` is that within the element.
    """
    text = sources.sheets.declared(element).get("filter", "none")
    if text.lower() == "none":
        return ()
    filters: list[Filter] = []
    try:
        for each in parse_filter_list(text):
            if isinstance(each, str):
                target = sources.document.ids.get(each[1:]) if each.startswith("#") else None
                if target is None or target.tag != "filter":
                    sources.warnings.broken("filter", "ignored", element.line)
                    continue
                filters.append(_read_filter(element, target, context, sources, images))
            else:
                color, is_linear = context.style.color, context.colors.is_linear
                filters.append(
                    filter_by_function(each, context.matrix, context.units, color, is_linear)
                )
    except InvalidFunctionError:
        sources.warnings.broken("filter", "ignored", element.line)
        return ()
    except UnsupportedPrimitiveError as error:
        sources.warnings.unsupported(f"filter with {error}", "ignored", element.line)
        return ()
    return tuple(filters)


def _read_filter(
    element: SvgElement,
    filter_element: SvgElement,
    context: Context,
    sources: Sources,
    images: Images,
) -> Filter:
    box = object_bounds(element, context, sources)
    context = replace(context, uses=(*context.uses, element))
    region, matrix = read_region(filter_element, "filterUnits", _DEFAULTS, box, context, sources)
    if region is None:
        return Filter((), _EMPTY_BOX, context.matrix, context.colors.is_linear)
    units = (
        fractions_to_box(box)
        if filter_element.get("primitiveUnits") == "objectBoundingBox"
        else IDENTITY
    )
    filter_units = FilterUnits(units or IDENTITY, transform_box(region, matrix))
    steps = tuple(
        _read_step(child, filter_units, context, sources, images)
        for child in filter_element
        if isinstance(child, SvgElement) and child.tag.startswith("fe")
    )
    return Filter(steps, filter_units.region, context.matrix, context.colors.is_linear)


def _read_step(
    element: SvgElement,
    filter_units: FilterUnits,
    context: Context,
    sources: Sources,
    images: Images,
) -> Step:
    kind = PRIMITIVE_READERS.get(element.tag)
    if kind is None:
        raise UnsupportedPrimitiveError(f"<{element.tag}>")
    inputs, numbers, name = kind(element, filter_units, sources)
    for each in inputs:
        if each in _UNSUPPORTED_INPUTS:
            sources.warnings.unsupported(each, "replaced by the result before it", element.line)
    style = sources.sheets.style(element)
    region = _subregion(element, filter_units, context, sources)
    return Step(
        element.tag if name != "nothing" else name,
        tuple(inputs),
        element.get("result", ""),
        tuple(min(max(number, -_LARGEST), _LARGEST) for number in numbers),
        name,
        style.color_interpolation_filters != "srgb",
        region,
        _image_contents(element, region or filter_units.region, context, sources, images),
    )


def _subregion(
    element: SvgElement, filter_units: FilterUnits, context: Context, sources: Sources
) -> Box | None:
    """Returns the subregion of a primitive, in the element's units; None for the default."""
    declared = sources.sheets.declared(element)
    if not any(name in declared for name in _DEFAULTS):
        return None
    left, top, right, bottom = filter_units.region
    sides = {"x": left, "y": top, "width": right - left, "height": bottom - top}
    units = context.units
    if filter_units.matrix != IDENTITY:
        units = Units(1.0, 1.0, units.font_size)
    a, _, _, d, e, f = filter_units.matrix
    for name in sides:
        if name in declared:
            value = sources.pixels(element, name, Length(0.0), units)
            scale, shift = (a, e) if name in ("x", "width") else (d, f)
            sides[name] = value * scale + (shift if len(name) == 1 else 0.0)
    x, y, width, height = sides.values()
    return x, y, x + max(width, 0.0), y + max(height, 0.0)


def _image_contents(
    element: SvgElement,
    region: Box,
    context: Context,
    sources: Sources,
    images: Images,
) -> Group | None:
    """Returns the contents of `feImage`; None for other primitives."""
    if element.tag != "feImage":
        return None
    group = Group(is_isolated=True, line=element.line)
    target = sources.document.ids.get(element.href)
    left, top, right, bottom = region
    inside = replace(context, target=group, clips=(), use=None)
    if target is None:
        inside = replace(inside, style=sources.sheets.style(element))
        place_image(element, (left, top, right - left, bottom - top), inside, sources, images)
    elif any(target in ancestors(used) for used in context.uses):
        raise InvalidFunctionError  # The image contains itself.
    else:
        parent = target.parent
        inside = replace(
            inside,
            style=sources.sheets.style(parent) if parent is not None else Style(),
            matrix=compose(context.matrix, translation(left, top)),
            uses=(*context.uses, target),
            use=element,
        )
        sources.schedule(((target, inside),))
    return group
