# SPDX-License-Identifier: GPL-3.0-or-later

"""Patterns."""

from collections.abc import Mapping

from ...affine import IDENTITY, Matrix, compose, determinant, translation
from ..model.tree import Box, Clip, Group, Pattern, make_box_clip
from ..model.values import Length, parse_transform
from ..model.view_boxes import MAX_UNITS, fit_view_box, parse_view_box
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.lengths import Units, read_length, transform_about_origin
from ..read.nesting import VISIBLE_OVERFLOW, rendered_children
from .masks import fractions_to_box

_NAMES = ("x", "y", "width", "height")
_INHERITED: tuple[str, ...] = (*_NAMES, "patternUnits", "patternContentUnits", "patternTransform")
_INHERITED += ("viewBox", "preserveAspectRatio", "overflow", "transform-origin")


def read_pattern(
    element: SvgElement, opacity: float, context: Context, bounds: Box | None, sources: Sources
) -> Pattern | None:
    """Reads a pattern as a paint; returns None if it paints nothing.

    Args:
        opacity: Opacity of the paint, in [0, 1].
        context: The context within the painted element.
        bounds: Bounding box of its outline.
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
    own = transform_about_origin(own, attributes.get("transform-origin", ""), context.units) or own
    if contents is None or tile is None or determinant(own) == 0.0:
        return None
    placement = _place_contents(attributes, tile, bounds)
    if placement is None:
        return None
    matrix, size = placement
    group = Group(is_isolated=True, line=element.line)
    clips: tuple[Clip, ...] = ()
    if attributes.get("overflow", "hidden") not in VISIBLE_OVERFLOW:
        clips = (make_box_clip(tile, IDENTITY),)
    contents_context = Context(
        sources.sheets.style(contents),
        matrix,
        size or context.viewport,
        group,
        context.colors,
        clips,
        (*context.uses, element),
    )
    sources.schedule((child, contents_context) for child in rendered_children(contents))
    return Pattern(group, tile, own, opacity)


def _tile(
    element: SvgElement,
    attributes: Mapping[str, str],
    context: Context,
    bounds: Box | None,
    sources: Sources,
) -> Box | None:
    """Returns the tile in the outline's units; None if it is empty."""
    is_fraction = attributes.get("patternUnits") != "userSpaceOnUse"
    units = Units(1.0, 1.0, context.units.font_size) if is_fraction else context.units
    x, y, width, height = (
        units.pixels(read_length(element, attributes, name, sources.warnings) or Length(0.0), name)
        for name in _NAMES
    )
    if is_fraction:
        to_box = fractions_to_box(bounds)
        if to_box is None:
            return None
        a, _, _, d, e, f = to_box
        x, y, width, height = e + x * a, f + y * d, width * a, height * d
    if width <= 0.0 or height <= 0.0:
        return None
    if not all(1.0 / MAX_UNITS < side < MAX_UNITS for side in (width, height)):
        sources.warnings.broken("<pattern>", "left out, for its size", element.line)
        return None
    return x, y, x + width, y + height


def _place_contents(
    attributes: Mapping[str, str], tile: Box, bounds: Box | None
) -> tuple[Matrix, tuple[float, float] | None] | None:
    """Returns the matrix from the contents' units to the outline's, and the contents' viewport if
    they have one of their own.
    """
    matrix: Matrix = translation(tile[0], tile[1])
    view = parse_view_box(attributes.get("viewBox"))
    if view is not None:
        aspect = attributes.get("preserveAspectRatio", "")
        fitted = fit_view_box(view, aspect, tile[2] - tile[0], tile[3] - tile[1])
        return compose(matrix, fitted), (view.width, view.height)
    if attributes.get("patternContentUnits") == "objectBoundingBox":
        to_box = fractions_to_box(bounds)
        if to_box is None:
            return None
        scale = (to_box[0], 0.0, 0.0, to_box[3], 0.0, 0.0)
        return compose(matrix, scale), (1.0, 1.0)
    return matrix, None


def _chain(element: SvgElement, sources: Sources) -> tuple[dict[str, str], SvgElement | None]:
    """Collects attributes along the chain of references; returns the first pattern with children,
    too.
    """
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
