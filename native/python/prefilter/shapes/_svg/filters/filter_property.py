# SPDX-License-Identifier: GPL-3.0-or-later

"""Filters: what becomes of a group's pixels, step by step, as the file says it."""

from dataclasses import replace

from ...affine import IDENTITY, multiplied
from ..model.tree import Box, Filter, Group, Step, transform_box
from ..model.values import Length
from ..paint.bounds import object_bounds
from ..paint.images import Images, put_image
from ..paint.masks import fractions_to_box, read_region
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.lengths import Units
from ..read.nesting import ancestors
from ..read.styles import Style
from .functions import InvalidFunctionError, filter_by_function, listed
from .primitives import STEPS, FilterPlace, UnknownStepError

# Products of larger numbers would leave the range of floats.
_LARGEST = 1e9
# What no browser has, and that is for them as if it was not said.
_REPLACED = ("BackgroundImage", "BackgroundAlpha", "FillPaint", "StrokePaint")
_NOTHING = (0.0, 0.0, 0.0, 0.0)
_DEFAULTS = {"x": -10.0, "y": -10.0, "width": 120.0, "height": 120.0}


def filters_of(
    element: SvgElement, context: Context, sources: Sources, images: Images
) -> tuple[Filter, ...]:
    """The filters of an element, the first to be applied first; none where one is wrong.

    `context` is that within the element.
    """
    text = sources.sheets.declared(element).get("filter", "none")
    if text.lower() == "none":
        return ()
    found: list[Filter] = []
    try:
        for each in listed(text):
            if isinstance(each, str):
                target = sources.document.ids.get(each[1:]) if each.startswith("#") else None
                if target is None or target.tag != "filter":
                    sources.warnings.broken("filter", "ignored", element.line)
                    continue
                found.append(_referred(element, target, context, sources, images))
            else:
                color, is_linear = context.style.color, context.colors.is_linear
                found.append(
                    filter_by_function(each, context.matrix, context.units, color, is_linear)
                )
    except InvalidFunctionError:
        sources.warnings.broken("filter", "ignored", element.line)
        return ()
    except UnknownStepError as error:
        sources.warnings.unsupported(f"filter with {error}", "ignored", element.line)
        return ()
    return tuple(found)


def _referred(
    element: SvgElement, found: SvgElement, context: Context, sources: Sources, images: Images
) -> Filter:
    box = object_bounds(element, context, sources)
    context = replace(context, uses=(*context.uses, element))
    region, matrix = read_region(found, "filterUnits", _DEFAULTS, box, context, sources)
    if region is None:
        return Filter((), _NOTHING, context.matrix, context.colors.is_linear)
    units = (
        fractions_to_box(box) if found.get("primitiveUnits") == "objectBoundingBox" else IDENTITY
    )
    place = FilterPlace(units or IDENTITY, transform_box(region, matrix))
    steps = tuple(
        _step(child, place, context, sources, images)
        for child in found
        if isinstance(child, SvgElement) and child.tag.startswith("fe")
    )
    return Filter(steps, place.region, context.matrix, context.colors.is_linear)


def _step(
    element: SvgElement, place: FilterPlace, context: Context, sources: Sources, images: Images
) -> Step:
    kind = STEPS.get(element.tag)
    if kind is None:
        raise UnknownStepError(f"<{element.tag}>")
    inputs, numbers, name = kind(element, place, sources)
    for each in inputs:
        if each in _REPLACED:
            sources.warnings.unsupported(each, "replaced by the result before it", element.line)
    style = sources.sheets.style(element)
    region = _subregion(element, place, context, sources)
    return Step(
        element.tag if name != "nothing" else name,
        tuple(inputs),
        element.get("result", ""),
        tuple(min(max(number, -_LARGEST), _LARGEST) for number in numbers),
        name,
        style.color_interpolation_filters != "srgb",
        region,
        _shown(element, region or place.region, context, sources, images),
    )


def _subregion(
    element: SvgElement, place: FilterPlace, context: Context, sources: Sources
) -> Box | None:
    """Where the result of a step ends, in the element's units; None for that of the filter."""
    declared = sources.sheets.declared(element)
    if not any(name in declared for name in _DEFAULTS):
        return None
    left, top, right, bottom = place.region
    sides = {"x": left, "y": top, "width": right - left, "height": bottom - top}
    units = context.units
    if place.units != IDENTITY:
        units = Units(1.0, 1.0, units.font_size)
    a, _, _, d, e, f = place.units
    for name in sides:
        if name in declared:
            value = sources.pixels(element, name, Length(0.0), units)
            scale, shift = (a, e) if name in ("x", "width") else (d, f)
            sides[name] = value * scale + (shift if len(name) == 1 else 0.0)
    x, y, width, height = sides.values()
    return x, y, x + max(width, 0.0), y + max(height, 0.0)


def _shown(
    element: SvgElement,
    region: Box,
    context: Context,
    sources: Sources,
    images: Images,
) -> Group | None:
    """What an `feImage` shows; None for other steps."""
    if element.tag != "feImage":
        return None
    group = Group(is_isolated=True, line=element.line)
    target = sources.document.ids.get(element.href)
    left, top, right, bottom = region
    inside = replace(context, target=group, clips=(), use=None)
    if target is None:
        inside = replace(inside, style=sources.sheets.style(element))
        put_image(element, (left, top, right - left, bottom - top), inside, sources, images)
    elif any(target in ancestors(used) for used in context.uses):
        raise InvalidFunctionError  # It is inside of itself.
    else:
        parent = target.parent
        inside = replace(
            inside,
            style=sources.sheets.style(parent) if parent is not None else Style(),
            matrix=multiplied(context.matrix, (1.0, 0.0, 0.0, 1.0, left, top)),
            uses=(*context.uses, target),
            use=element,
        )
        sources.schedule(((target, inside),))
    return group
