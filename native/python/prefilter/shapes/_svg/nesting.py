# SPDX-License-Identifier: GPL-3.0-or-later

"""Elements in others: children, what `use` brings, and viewports of their own."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from .context import Context, Sources
from .document import SvgElement
from .groups import Groups, carried
from .values import Length, multiplied
from .viewports import as_view_box, placed

_ZERO, _WHOLE = Length(0.0), Length(100.0, "%")


def children(element: SvgElement) -> Iterator[SvgElement]:
    """Yields the elements in another; of a `switch` the first that can be shown."""
    for child in element:
        assert isinstance(child, SvgElement)
        if element.tag != "switch":
            yield child
        elif "requiredExtensions" not in child.attrib and not child.tag.startswith("{"):
            languages = child.attrib.get("systemLanguage", "en").split(",")
            if any(name.strip().lower().startswith("en") for name in languages):
                yield child
                return


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
    if target in context.uses or target in _ancestors(element):
        sources.warnings.broken("<use>", "left out, as it is inside of itself", element.line)
        return
    x = sources.pixels(element, "x", _ZERO, context.units)
    y = sources.pixels(element, "y", _ZERO, context.units)
    context = replace(
        context,
        matrix=multiplied(context.matrix, (1.0, 0.0, 0.0, 1.0, x, y)),
        uses=(*context.uses, target),
        use=element,
    )
    yield target, context


def viewport(
    element: SvgElement,
    declared: Mapping[str, str],
    context: Context,
    sources: Sources,
    groups: Groups,
) -> Context | None:
    """The context inside of an `svg` or `symbol`; None where nothing shows."""
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
    around = context.groups
    if declared.get("overflow", "hidden") not in ("visible", "auto"):
        region = carried((x, y, x + width, y + height), context.matrix)
        around = (*around, groups.add_clipped(element, "overflow", region))
    view = as_view_box(declared.get("viewBox"))
    if view is not None:
        fitted = placed(view, declared.get("preserveAspectRatio", ""), width, height)
        matrix = multiplied(matrix, fitted)
        size = (view.width, view.height)
    matrix = multiplied(context.matrix, matrix)
    return replace(context, matrix=matrix, viewport=size, groups=around)


def _ancestors(element: SvgElement) -> Iterator[SvgElement]:
    at: SvgElement | None = element
    while at is not None:
        yield at
        at = at.parent
