# SPDX-License-Identifier: GPL-3.0-or-later

"""Number of elements drawn through references."""

from collections.abc import Iterator

from ..model import limits
from ..model.limits import TOO_MANY_USED, TooLargeError
from ..model.values import parse_paint
from .document import NOT_DRAWN, Document, SvgElement
from .styles import StyleSheets

_REFERRING = {"mask", "fill", "stroke", "marker-start", "marker-mid", "marker-end"}


def check_repetition(document: Document, sheets: StyleSheets) -> None:
    """Raises TooLargeError if references by `use`, masks, patterns and markers repeat too many
    elements. Nothing is drawn before.
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
            # An element met again before it is finished contains itself, and counts 0.
            counts[element] = 0
            waiting.append((element, True))
            waiting.extend((each, False) for each in _drawn_by(element, document, sheets))
    if counts[document.root] > document.count + limits.MAX_USED:
        raise TooLargeError(TOO_MANY_USED.format(limits.MAX_USED))


def _drawn_by(element: SvgElement, document: Document, sheets: StyleSheets) -> Iterator[SvgElement]:
    """Yields the elements that an element draws directly."""
    declared = sheets.declared(element)
    for name in _REFERRING & declared.keys():
        paint = parse_paint(declared[name])
        target_of_paint = document.ids.get(paint.server[1:]) if paint is not None else None
        if target_of_paint is not None and target_of_paint.tag in ("mask", "pattern", "marker"):
            yield target_of_paint
    if element.tag == "use":
        target = document.ids.get(element.href)
        if target is not None:
            yield target
        return
    for child in element:
        assert isinstance(child, SvgElement)
        if child.tag not in NOT_DRAWN and child.tag != "symbol":
            yield child
