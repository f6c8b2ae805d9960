# SPDX-License-Identifier: GPL-3.0-or-later

"""Patterns: what outlines are painted with again and again."""

from collections.abc import Mapping

from ...affine import IDENTITY, Matrix, determinant, multiplied
from ..model.clips import make_box_clip
from ..model.tree import Box, Clip, Group, Pattern
from ..model.values import Length, parse_transform
from ..model.view_boxes import MAX_UNITS, fit_view_box, parse_view_box
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.lengths import Units, about_origin, read_length
from ..read.nesting import VISIBLE_OVERFLOW, rendered_children
from .masks import shares_of

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
    tile = _tile(element, attributes, context, bounds, sources)
    own = parse_transform(attributes.get("patternTransform", ""))
    if own is None:
        sources.warnings.broken("patternTransform", "ignored", element.line)
        own = IDENTITY
    own = about_origin(own, attributes.get("transform-origin", ""), context.units) or own
    if contents is None or tile is None or determinant(own) == 0.0:
        return None
    found = _contents_place(attributes, tile, bounds)
    if found is None:
        return None
    matrix, size = found
    group = Group(is_isolated=True, line=element.line)
    clips: tuple[Clip, ...] = ()
    if attributes.get("overflow", "hidden") not in VISIBLE_OVERFLOW:
        clips = (make_box_clip(tile, IDENTITY),)
    place = Context(
        sources.sheets.style(contents),
        matrix,
        size or context.viewport,
        group,
        context.colors,
        clips,
        (*context.uses, element),
    )
    sources.schedule((child, place) for child in rendered_children(contents))
    return Pattern(group, tile, own, opacity)


def _tile(
    element: SvgElement,
    attributes: Mapping[str, str],
    context: Context,
    bounds: Box | None,
    sources: Sources,
) -> Box | None:
    """What is repeated, in the units of the outline; None where it is nothing."""
    is_share = attributes.get("patternUnits") != "userSpaceOnUse"
    units = Units(1.0, 1.0, context.units.font_size) if is_share else context.units
    x, y, width, height = (
        units.pixels(read_length(element, attributes, name, sources.warnings) or Length(0.0), name)
        for name in _NAMES
    )
    if is_share:
        shares = shares_of(bounds)
        if shares is None:
            return None
        a, _, _, d, e, f = shares
        x, y, width, height = e + x * a, f + y * d, width * a, height * d
    if width <= 0.0 or height <= 0.0:
        return None
    if not all(1.0 / MAX_UNITS < side < MAX_UNITS for side in (width, height)):
        sources.warnings.broken("<pattern>", "left out, for its size", element.line)
        return None
    return x, y, x + width, y + height


def _contents_place(
    attributes: Mapping[str, str], tile: Box, bounds: Box | None
) -> tuple[Matrix, tuple[float, float] | None] | None:
    """From the units of what is in a pattern to those of the outline, and its own viewport."""
    matrix: Matrix = (1.0, 0.0, 0.0, 1.0, tile[0], tile[1])
    view = parse_view_box(attributes.get("viewBox"))
    if view is not None:
        aspect = attributes.get("preserveAspectRatio", "")
        fitted = fit_view_box(view, aspect, tile[2] - tile[0], tile[3] - tile[1])
        return multiplied(matrix, fitted), (view.width, view.height)
    if attributes.get("patternContentUnits") == "objectBoundingBox":
        shares = shares_of(bounds)
        if shares is None:
            return None
        scale = (shares[0], 0.0, 0.0, shares[3], 0.0, 0.0)
        return multiplied(matrix, scale), (1.0, 1.0)
    return matrix, None


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
