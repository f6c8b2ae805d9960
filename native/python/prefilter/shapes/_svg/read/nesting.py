# SPDX-License-Identifier: GPL-3.0-or-later

"""Nested elements: children, contents of `use`, and viewports."""

from collections.abc import Iterator
from dataclasses import replace

from ...affine import compose, translation
from ..model.tree import make_box_clip
from ..model.values import Length
from ..model.view_boxes import fit_view_box, parse_view_box
from .basic_shapes import BASIC_SHAPES
from .context import Context, Sources, context_paints
from .document import GROUPS, SvgElement
from .transforms import read_transform

_ZERO, _WHOLE = Length(0.0), Length(100.0, "%")
FOREIGN = "foreignObject"
RENDERED_TAGS = frozenset((*GROUPS, *BASIC_SHAPES, "use", "image", "text"))
"""Elements that draw something."""
VISIBLE_OVERFLOW = ("visible", "auto")
"""Values of `overflow` that do not clip."""


def rendered_children(element: SvgElement) -> Iterator[SvgElement]:
    """Yields an element's children; for a `switch`, only the first one that can be rendered."""
    for child in element:
        assert isinstance(child, SvgElement)
        if element.tag != "switch":
            yield child
        elif passes_conditions(child) and child.tag in RENDERED_TAGS:
            yield child
            return


def passes_conditions(element: SvgElement) -> bool:
    """Evaluates conditional attributes, for an English reader and without extensions."""
    if "requiredExtensions" in element.attrib:
        return False
    languages = element.attrib.get("systemLanguage", "en").split(",")
    return any(name.strip().lower().startswith("en") for name in languages)


def enter_element(element: SvgElement, context: Context, sources: Sources) -> Context:
    """Returns the context within an element: with its style, and in its units."""
    style = sources.sheets.inherit_style(element, context.style)
    declared = sources.sheets.declared(element)
    inside = context if style is context.style else replace(context, style=style)
    matrix = read_transform(element, declared, inside, sources)
    if matrix is None:
        return inside
    return replace(inside, matrix=compose(context.matrix, matrix))


def resolve_use(
    element: SvgElement, context: Context, sources: Sources
) -> Iterator[tuple[SvgElement, Context]]:
    """Yields the target of a `use`, with its context."""
    target = sources.document.ids.get(element.href)
    if target is None:
        sources.warnings.broken("<use>", "left out, as its target is missing", element.line)
        return
    if target in context.uses or target in ancestors(element):
        sources.warnings.broken("<use>", "left out, as it is inside of itself", element.line)
        return
    x = sources.pixels(element, "x", _ZERO, context.units)
    y = sources.pixels(element, "y", _ZERO, context.units)
    context = replace(
        context,
        matrix=compose(context.matrix, translation(x, y)),
        uses=(*context.uses, target),
        use=element,
        paints=context_paints(element, context),
    )
    yield target, context


def enter_viewport(element: SvgElement, context: Context, sources: Sources) -> Context | None:
    """Returns the context within an `svg` or `symbol`; None if its viewport is empty."""
    declared = sources.sheets.declared(element)
    sizes = []
    for name in ("width", "height"):
        source = element
        if context.use is not None and name in sources.sheets.declared(context.use):
            source = context.use
        sizes.append(sources.pixels(source, name, _WHOLE, context.units))
    x = y = 0.0
    if element.tag == "svg":
        x = sources.pixels(element, "x", _ZERO, context.units)
        y = sources.pixels(element, "y", _ZERO, context.units)
    width, height = sizes
    if width <= 0.0 or height <= 0.0:
        return None
    matrix = translation(x, y)
    size = (width, height)
    clips = context.clips
    if declared.get("overflow", "hidden") not in VISIBLE_OVERFLOW:
        clips = (*clips, make_box_clip((x, y, x + width, y + height), context.matrix))
    view = parse_view_box(declared.get("viewBox"))
    if view is not None:
        fitted = fit_view_box(view, declared.get("preserveAspectRatio", ""), width, height)
        matrix = compose(matrix, fitted)
        size = (view.width, view.height)
    matrix = compose(context.matrix, matrix)
    return replace(context, matrix=matrix, viewport=size, clips=clips)


def ancestors(element: SvgElement) -> Iterator[SvgElement]:
    """Yields an element and its ancestors."""
    at: SvgElement | None = element
    while at is not None:
        yield at
        at = at.parent
