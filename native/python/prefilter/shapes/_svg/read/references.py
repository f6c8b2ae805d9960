# SPDX-License-Identifier: GPL-3.0-or-later

"""References between elements: how many elements they repeat."""

from collections.abc import Iterator

from ..model import limits
from ..model.limits import TOO_MANY_USED, TooLargeError
from ..model.values import as_paint
from .document import Document, SvgElement
from .styles import StyleSheets
from .tags import NOT_DRAWN

_REFERRING = {"mask", "fill", "stroke", "marker-start", "marker-mid", "marker-end"}


def check_uses(document: Document, sheets: StyleSheets) -> None:
    """Raises TooLargeError where `use`, masks and others that elements refer to repeat too many
    elements, before any is drawn.
    """
    counts: dict[SvgElement, int] = {}
    waiting = [(document.root, False)]
    while waiting:
        element, is_done = waiting.pop()
        if is_done:
            counts[element] = 1 + sum(
                counts.get(each, 0) for each in _drawn_by(element, document, sheets)
            )
        elif element not in counts:
            # It is inside of itself where it is met again before it is done.
            counts[element] = 0
            waiting.append((element, True))
            waiting.extend((each, False) for each in _drawn_by(element, document, sheets))
    if counts[document.root] > document.count + limits.MOST_USED:
        raise TooLargeError(TOO_MANY_USED.format(limits.MOST_USED))


def _drawn_by(element: SvgElement, document: Document, sheets: StyleSheets) -> Iterator[SvgElement]:
    """Yields the elements that one draws."""
    declared = sheets.declared(element)
    for name in _REFERRING & declared.keys():
        paint = as_paint(declared[name])
        brought = document.ids.get(paint.server[1:]) if paint is not None else None
        if brought is not None and brought.tag in ("mask", "pattern", "marker"):
            yield brought
    if element.tag == "use":
        target = document.ids.get(element.href)
        if target is not None:
            yield target
        return
    for child in element:
        assert isinstance(child, SvgElement)
        if child.tag not in NOT_DRAWN and child.tag != "symbol":
            yield child
