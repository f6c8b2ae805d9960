# SPDX-License-Identifier: GPL-3.0-or-later

"""Order of characters in bidirectional text.

The Unicode Bidirectional Algorithm (UAX #9), rules W1 to W7, N0 to N2, I1, I2 and L2. Embedding and
isolating characters (X1 to X10) are ignored: drawings use elements and properties instead.
"""

import unicodedata
from collections.abc import Sequence

_STRONG = ("L", "R", "AL")
_NEUTRAL = frozenset(("B", "S", "WS", "ON"))
_IGNORED = frozenset(("BN", "LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"))
_BRACKETS = {"(": ")", "[": "]", "{": "}", "\u2329": "\u232a", "\u3008": "\u3009"}
_CLOSING = {closing: opening for opening, closing in _BRACKETS.items()}
_MAX_OPEN = 63


def embedding_levels(text: str, base: int, forced: Sequence[str] = ()) -> list[int]:
    """Returns the embedding levels of characters; odd levels are right-to-left.

    Args:
        text: A paragraph.
        base: Level of the paragraph: 0 for left-to-right, 1 for right-to-left.
        forced: "L" or "R" for overridden characters, "" for others; may be empty.
    """
    if base == 0 and not any(forced) and all(ord(each) < 0x590 for each in text):
        return [0] * len(text)
    kinds = [unicodedata.bidirectional(each) or "L" for each in text]
    for index, kind in enumerate(forced):
        kinds[index] = kind or kinds[index]
    kept_indices = [index for index, kind in enumerate(kinds) if kind not in _IGNORED]
    run = [kinds[index] for index in kept_indices]
    marks = [kind == "NSM" for kind in run]
    embedding = "R" if base % 2 else "L"
    _resolve_weak(run, embedding)
    _resolve_brackets(run, [text[index] for index in kept_indices], marks, embedding)
    _resolve_neutral(run, embedding)
    levels = [base] * len(text)
    for index, kind in zip(kept_indices, run, strict=True):
        if base % 2:
            levels[index] = base + (kind != "R")
        else:
            levels[index] = base + {"L": 0, "R": 1}.get(kind, 2)
    for index in range(1, len(text)):
        if kinds[index] in _IGNORED:
            levels[index] = levels[index - 1]
    return levels


def _resolve_weak(run: list[str], outer: str) -> None:
    """Rules W1 to W7: weak types."""
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


def _resolve_brackets(
    run: list[str], text: Sequence[str], marks: Sequence[bool], outer: str
) -> None:
    """Rule N0: paired brackets."""
    opened: list[tuple[str, int]] = []
    pairs: list[tuple[int, int]] = []
    for index, character in enumerate(text):
        if run[index] != "ON":
            continue
        if character in _BRACKETS:
            if len(opened) >= _MAX_OPEN:
                return
            opened.append((character, index))
        elif character in _CLOSING:
            for position in range(len(opened) - 1, -1, -1):
                if opened[position][0] == _CLOSING[character]:
                    pairs.append((opened[position][1], index))
                    del opened[position:]
                    break
    for first, last in sorted(pairs):
        inside = {_direction(kind) for kind in run[first + 1 : last]} - {""}
        if not inside:
            continue
        direction = outer
        if outer not in inside:
            before = next(
                (strong for kind in run[first::-1] if (strong := _direction(kind))), outer
            )
            direction = before if before in inside else outer
        for position in (first, last):
            run[position] = direction
            # Marks on a bracket take its direction.
            after = position + 1
            while after < len(run) and marks[after]:
                run[after] = direction
                after += 1


def _resolve_neutral(run: list[str], outer: str) -> None:
    """Rules N1 and N2: neutral types."""
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
    """Returns the indices of items with these levels, from left to right (rule L2)."""
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
