# SPDX-License-Identifier: GPL-3.0-or-later

"""Media queries, evaluated for a screen in light mode."""

from collections.abc import Sequence
from typing import Any

import tinycss2

_SCREEN_TYPES, _OTHER_TYPES = (
    ("all", "screen"),
    ("print", "speech", "tty", "projection", "handheld"),
)
_SCHEME = "prefers-color-scheme"


def matches_screen(query: str | Sequence[Any]) -> bool | None:
    """Evaluates a list of media queries; returns None if the result depends on unknown features.

    Args:
        query: Text or tokens. An empty query matches.
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
    results = [_evaluate_query(part) for part in parts]
    return True if True in results else None if None in results else False


def _evaluate_query(tokens: Sequence[Any]) -> bool | None:
    """Evaluates types and features joined by `and`."""
    words = [token.lower_value if token.type == "ident" else "" for token in tokens]
    is_not = words[:1] == ["not"]
    begin = 1 if words[:1] in (["not"], ["only"]) else 0
    results: list[bool | None] = []
    for index in range(begin, len(tokens)):
        if (index - begin) % 2:
            if words[index] != "and":
                return None
        else:
            results.append(_evaluate_feature(tokens[index], words[index]))
    if not results or (len(tokens) - begin) % 2 == 0:
        return None
    whole = False if False in results else None if None in results else True
    return not whole if is_not and whole is not None else whole


def _evaluate_feature(token: Any, word: str) -> bool | None:
    if word:
        return True if word in _SCREEN_TYPES else False if word in _OTHER_TYPES else None
    if token.type != "() block":
        return None
    inner = [each for each in token.content if each.type not in ("whitespace", "comment")]
    words = [each.lower_value if each.type == "ident" else str(each.serialize()) for each in inner]
    if len(words) == 3 and words[:2] == [_SCHEME, ":"] and words[2] in ("light", "dark"):
        return words[2] == "light"
    return None
