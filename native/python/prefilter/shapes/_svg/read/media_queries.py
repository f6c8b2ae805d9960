# SPDX-License-Identifier: GPL-3.0-or-later

"""Which media queries hold: for a screen with light colors."""

from collections.abc import Sequence
from typing import Any

import tinycss2

_SHOWN, _OTHERS = ("all", "screen"), ("print", "speech", "tty", "projection", "handheld")
_SCHEME = "prefers-color-scheme"


def holds_for_screens(query: str | Sequence[Any]) -> bool | None:
    """Whether one of a list of media queries holds; None where that depends on other things.

    Args:
        query: As text or as components. An empty one always holds.
    """
    tokens: Sequence[Any] = (
        tinycss2.parse_component_value_list(query) if isinstance(query, str) else query
    )
    parts: list[list[Any]] = [[]]
    for token in tokens:
        if token == ",":
            parts.append([])
        elif token.type not in ("whitespace", "comment"):
            parts[-1].append(token)
    if parts == [[]]:
        return True
    found = [_one(part) for part in parts]
    return True if True in found else None if None in found else False


def _one(tokens: Sequence[Any]) -> bool | None:
    """Whether a query of types and features that are joined by `and` holds."""
    words = [token.lower_value if token.type == "ident" else "" for token in tokens]
    is_not = words[:1] == ["not"]
    begin = 1 if words[:1] in (["not"], ["only"]) else 0
    found: list[bool | None] = []
    for index in range(begin, len(tokens)):
        if (index - begin) % 2:
            if words[index] != "and":
                return None
        else:
            found.append(_term(tokens[index], words[index]))
    if not found or (len(tokens) - begin) % 2 == 0:
        return None
    whole = False if False in found else None if None in found else True
    return not whole if is_not and whole is not None else whole


def _term(token: Any, word: str) -> bool | None:
    if word:
        return True if word in _SHOWN else False if word in _OTHERS else None
    if token.type != "() block":
        return None
    inner = [each for each in token.content if each.type not in ("whitespace", "comment")]
    said = [each.lower_value if each.type == "ident" else str(each.serialize()) for each in inner]
    if len(said) == 3 and said[:2] == [_SCHEME, ":"] and said[2] in ("light", "dark"):
        return said[2] == "light"
    return None
