# SPDX-License-Identifier: GPL-3.0-or-later

"""Patterns: what outlines are painted with again and again."""

from .clips import box_clip
from .context import Context, Sources
from .document import SvgElement
from .lengths import Units, about_origin, read_length
from .nesting import SHOWN, children
from .tree import Box, Clip, Group, Pattern
from .values import IDENTITY, Length, as_transform, determinant, multiplied
from .viewports import MOST_UNITS, as_view_box, placed

_NAMES = ("x", "y", "width", "height")
_INHERITED: tuple[str, ...] = (*_NAMES, "patternUnits", "patternContentUnits", "patternTransform")
_INHERITED += ("viewBox", "preserveAspectRatio", "overflow", "transform-origin")


def pattern_of(
    element: SvgElement, opacity: float, context: Context, bounds: Box | None, sources: Sources
) -> Pattern | None:
    """What a pattern paints; None for nothing.

    Args:
        element: The pattern.
        opacity: Of the paint, in [0, 1].
        context: Within the element that is painted.
        bounds: Of its outline.
        sources: What the pattern is read with.
    """
    if element in context.uses:
        sources.warnings.broken("<pattern>", "left out, as it is inside of itself", element.line)
        return None
    attributes, contents = _chain(element, sources)
    is_share = attributes.get("patternUnits") != "userSpaceOnUse"
    units = context.units
    if is_share:
        units = Units(1.0, 1.0, units.font_size)
    x, y, width, height = (
        units.pixels(read_length(element, attributes, name, sources.warnings) or Length(0.0), name)
        for name in _NAMES
    )
    has_area = bounds is not None and bounds[2] > bounds[0] and bounds[3] > bounds[1]
    if is_share and bounds is not None and has_area:
        left, top, right, bottom = bounds
        x, y = left + x * (right - left), top + y * (bottom - top)
        width, height = width * (right - left), height * (bottom - top)
    elif is_share:
        return None
    own = as_transform(attributes.get("patternTransform", ""))
    if own is None:
        sources.warnings.broken("patternTransform", "ignored", element.line)
        own = IDENTITY
    own = about_origin(own, attributes.get("transform-origin", ""), context.units) or own
    if contents is None or width <= 0.0 or height <= 0.0 or determinant(own) == 0.0:
        return None
    if not all(1.0 / MOST_UNITS < side < MOST_UNITS for side in (width, height)):
        sources.warnings.broken("<pattern>", "left out, for its size", element.line)
        return None
    matrix, size = IDENTITY, context.viewport
    view = as_view_box(attributes.get("viewBox"))
    if view is not None:
        fitted = placed(view, attributes.get("preserveAspectRatio", ""), width, height)
        matrix = multiplied((1.0, 0.0, 0.0, 1.0, x, y), fitted)
        size = (view.width, view.height)
    else:
        matrix = (1.0, 0.0, 0.0, 1.0, x, y)
        if attributes.get("patternContentUnits") == "objectBoundingBox":
            if bounds is None or not has_area:
                return None
            scale = (bounds[2] - bounds[0], 0.0, 0.0, bounds[3] - bounds[1], 0.0, 0.0)
            matrix, size = multiplied(matrix, scale), (1.0, 1.0)
    tile = (x, y, x + width, y + height)
    group = Group(is_isolated=True, line=element.line)
    clips: tuple[Clip, ...] = ()
    if attributes.get("overflow", "hidden") not in SHOWN:
        clips = (box_clip(tile, IDENTITY),)
    place = Context(
        sources.sheets.style(contents),
        matrix,
        size,
        group,
        context.colors,
        clips,
        (*context.uses, element),
    )
    sources.draw((child, place) for child in children(contents))
    return Pattern(group, tile, own, opacity)


def _chain(element: SvgElement, sources: Sources) -> tuple[dict[str, str], SvgElement | None]:
    """The attributes of a pattern and of those that it refers to, and the first with children."""
    attributes: dict[str, str] = {}
    contents: SvgElement | None = None
    seen: set[SvgElement] = set()
    at: SvgElement | None = element
    while at is not None and at.tag == "pattern" and at not in seen:
        seen.add(at)
        declared = sources.sheets.declared(at)
        for name in _INHERITED:
            if name in declared:
                attributes.setdefault(name, declared[name])
        if contents is None and len(at):
            contents = at
        at = sources.document.ids.get(at.href)
    return attributes, contents
