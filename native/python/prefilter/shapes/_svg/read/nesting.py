# SPDX-License-Identifier: GPL-3.0-or-later

"""Elements in others: children, what `use` brings, and viewports of their own."""

from collections.abc import Iterator
from dataclasses import replace

from ...affine import multiplied
from ..model.clips import box_clip
from ..model.values import Length
from ..model.view_boxes import as_view_box, placed
from .basic_shapes import BASIC_SHAPES
from .context import Context, Sources, paints_of
from .document import SvgElement
from .tags import GROUPS
from .transforms import own_transform

_ZERO, _WHOLE = Length(0.0), Length(100.0, "%")
FOREIGN = "foreignObject"
DRAWN = frozenset((*GROUPS, *BASIC_SHAPES, "use", "image", "text"))
"""Elements of which something is drawn."""
SHOWN = ("visible", "auto")
"""The values of `overflow` that cut nothing off."""


def children(element: SvgElement) -> Iterator[SvgElement]:
    """Yields the elements in another; of a `switch` the first that can be shown."""
    for child in element:
        assert isinstance(child, SvgElement)
        if element.tag != "switch":
            yield child
        elif is_wanted(child) and child.tag in DRAWN:
            yield child
            return


def is_wanted(element: SvgElement) -> bool:
    """Whether an element is for those who read English, and needs nothing more than SVG."""
    if "requiredExtensions" in element.attrib:
        return False
    languages = element.attrib.get("systemLanguage", "en").split(",")
    return any(name.strip().lower().startswith("en") for name in languages)


def moved(element: SvgElement, context: Context, sources: Sources) -> Context:
    """The context within an element: with its style, and in its units."""
    style = sources.sheets.style_below(element, context.style)
    declared = sources.sheets.declared(element)
    inside = context if style is context.style else replace(context, style=style)
    matrix = own_transform(element, declared, inside, sources)
    if matrix is None:
        return inside
    return replace(inside, matrix=multiplied(context.matrix, matrix))


def used(
    element: SvgElement, context: Context, sources: Sources
) -> Iterator[tuple[SvgElement, Context]]:
    """Yields what a `use` refers to, with its context."""
    target = sources.document.ids.get(element.href)
    if target is None:
        sources.warnings.broken(
            "<use>", "left out, as what it refers to is not there", element.line
        )
        return
    if target in context.uses or target in ancestors(element):
        sources.warnings.broken("<use>", "left out, as it is inside of itself", element.line)
        return
    x = sources.pixels(element, "x", _ZERO, context.units)
    y = sources.pixels(element, "y", _ZERO, context.units)
    context = replace(
        context,
        matrix=multiplied(context.matrix, (1.0, 0.0, 0.0, 1.0, x, y)),
        uses=(*context.uses, target),
        use=element,
        paints=paints_of(element, context),
    )
    yield target, context


def viewport(element: SvgElement, context: Context, sources: Sources) -> Context | None:
    """The context inside of an `svg` or `symbol`; None where nothing shows."""
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
    matrix = (1.0, 0.0, 0.0, 1.0, x, y)
    size = (width, height)
    clips = context.clips
    if declared.get("overflow", "hidden") not in SHOWN:
        clips = (*clips, box_clip((x, y, x + width, y + height), context.matrix))
    view = as_view_box(declared.get("viewBox"))
    if view is not None:
        fitted = placed(view, declared.get("preserveAspectRatio", ""), width, height)
        matrix = multiplied(matrix, fitted)
        size = (view.width, view.height)
    matrix = multiplied(context.matrix, matrix)
    return replace(context, matrix=matrix, viewport=size, clips=clips)


def ancestors(element: SvgElement) -> Iterator[SvgElement]:
    """Yields an element and those that it is in."""
    at: SvgElement | None = element
    while at is not None:
        yield at
        at = at.parent
