# SPDX-License-Identifier: GPL-3.0-or-later

"""The order of letters where lines go to the left and to the right.

The Unicode Bidirectional Algorithm (UAX #9), rules W1 to W7, N0 to N2, I1, I2 and L2. Characters
that embed or isolate (X1 to X10) are ignored: elements and their properties do that in a drawing.
"""

import unicodedata
from collections.abc import Sequence

_STRONG = ("L", "R", "AL")
_NEUTRAL = frozenset(("B", "S", "WS", "ON"))
_IGNORED = frozenset(("BN", "LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"))
_BRACKETS = {"(": ")", "[": "]", "{": "}", "\u2329": "\u232a", "\u3008": "\u3009"}
_CLOSING = {closing: opening for opening, closing in _BRACKETS.items()}
_MAX_OPEN = 63


def levels_of(text: str, base: int, forced: Sequence[str] = ()) -> list[int]:
    """The embedding levels of characters: odd ones go to the left.

    Args:
        text: A paragraph.
        base: The level of the paragraph: 0 where it goes to the right, 1 to the left.
        forced: "L" or "R" for characters that an element overrides, "" for others; or nothing.
    """
    if base == 0 and not any(forced) and all(ord(each) < 0x590 for each in text):
        return [0] * len(text)
    kinds = [unicodedata.bidirectional(each) or "L" for each in text]
    for index, kind in enumerate(forced):
        kinds[index] = kind or kinds[index]
    at = [index for index, kind in enumerate(kinds) if kind not in _IGNORED]
    run = [kinds[index] for index in at]
    marks = [kind == "NSM" for kind in run]
    outer = "R" if base % 2 else "L"
    _weak(run, outer)
    _brackets(run, [text[index] for index in at], marks, outer)
    _neutral(run, outer)
    levels = [base] * len(text)
    for index, kind in zip(at, run, strict=True):
        if base % 2:
            levels[index] = base + (kind != "R")
        else:
            levels[index] = base + {"L": 0, "R": 1}.get(kind, 2)
    for index in range(1, len(text)):
        if kinds[index] in _IGNORED:
            levels[index] = levels[index - 1]
    return levels


def _weak(run: list[str], outer: str) -> None:
    """W1 to W7."""
    before, strong = outer, outer
    for index, kind in enumerate(run):
        if kind == "NSM":
            run[index] = kind = before
        before = kind
        if kind in _STRONG:
            strong = kind
        elif kind == "EN" and strong == "AL":
            run[index] = "AN"
    run[:] = ["R" if kind == "AL" else kind for kind in run]
    for index in range(1, len(run) - 1):
        left, kind, right = run[index - 1 : index + 2]
        if left == right and (
            (kind == "CS" and left in ("EN", "AN")) or (kind, left) == ("ES", "EN")
        ):
            run[index] = left
    index = 0
    while index < len(run):
        end = index
        while end < len(run) and run[end] == "ET":
            end += 1
        if end > index:
            touches = run[index - 1 : index] == ["EN"] or run[end : end + 1] == ["EN"]
            run[index:end] = ["EN" if touches else "ON"] * (end - index)
        index = max(end, index + 1)
    strong = outer
    for index, kind in enumerate(run):
        if kind in ("ES", "CS"):
            run[index] = "ON"
        elif kind in ("L", "R"):
            strong = kind
        elif kind == "EN" and strong == "L":
            run[index] = "L"


def _direction(kind: str) -> str:
    return {"L": "L", "R": "R", "EN": "R", "AN": "R"}.get(kind, "")


def _brackets(run: list[str], text: Sequence[str], marks: Sequence[bool], outer: str) -> None:
    """N0: pairs of brackets have one direction."""
    opened: list[tuple[str, int]] = []
    pairs: list[tuple[int, int]] = []
    for index, each in enumerate(text):
        if run[index] != "ON":
            continue
        if each in _BRACKETS:
            if len(opened) >= _MAX_OPEN:
                return
            opened.append((each, index))
        elif each in _CLOSING:
            for place in range(len(opened) - 1, -1, -1):
                if opened[place][0] == _CLOSING[each]:
                    pairs.append((opened[place][1], index))
                    del opened[place:]
                    break
    for first, last in sorted(pairs):
        inside = {_direction(kind) for kind in run[first + 1 : last]} - {""}
        if not inside:
            continue
        chosen = outer
        if outer not in inside:
            before = next((found for kind in run[first::-1] if (found := _direction(kind))), outer)
            chosen = before if before in inside else outer
        for place in (first, last):
            run[place] = chosen
            # Marks on a bracket follow it.
            after = place + 1
            while after < len(run) and marks[after]:
                run[after] = chosen
                after += 1


def _neutral(run: list[str], outer: str) -> None:
    """N1 and N2."""
    index = 0
    while index < len(run):
        end = index
        while end < len(run) and run[end] in _NEUTRAL:
            end += 1
        if end > index:
            before = _direction(run[index - 1]) if index else outer
            after = _direction(run[end]) if end < len(run) else outer
            run[index:end] = [before if before == after else outer] * (end - index)
        index = max(end, index + 1)


def visual_order(levels: Sequence[int]) -> list[int]:
    """The indices of things with these levels, from left to right (L2)."""
    order = list(range(len(levels)))
    odd = [level for level in levels if level % 2]
    if not odd:
        return order
    for level in range(max(levels), min(odd) - 1, -1):
        begin = 0
        while begin < len(order):
            end = begin
            while end < len(order) and levels[order[end]] >= level:
                end += 1
            if end > begin:
                order[begin:end] = order[begin:end][::-1]
            begin = max(end, begin + 1)
    return order
