# SPDX-License-Identifier: GPL-3.0-or-later

"""Variables of style sheets: properties whose names begin with --, and `var()`."""

from collections.abc import Mapping, Sequence
from typing import Any

import tinycss2

MOST_CHARACTERS = 1 << 16
"""Of a value with those of its variables: variables of variables could grow without end."""


class _InvalidError(Exception):
    """A variable has no value, or stands for itself."""


def uses_variables(text: str) -> bool:
    return "(" in text and "var(" in text.lower()


def variables(own: Mapping[str, str], around: Mapping[str, str]) -> dict[str, str]:
    """The variables of an element by their names; those without a valid value are not there.

    Args:
        own: As they are declared for it.
        around: Its parent's, with their values.
    """
    found = {name: text for name, text in around.items() if name not in own}
    for name, text in own.items():
        word = text.strip().lower()
        if word in ("inherit", "unset", "revert", "revert-layer"):
            if name in around:
                found[name] = around[name]
        elif word != "initial":
            try:
                found[name] = _resolved(text, _Values(own, around), (name,))
            except _InvalidError:
                found.pop(name, None)
    return found


def with_variables(text: str, values: Mapping[str, str]) -> str | None:
    """A value with those of its variables; None where one has none."""
    try:
        return _resolved(text, _Values({}, values), ()).strip()
    except _InvalidError:
        return None


class _Values:
    def __init__(self, own: Mapping[str, str], around: Mapping[str, str]) -> None:
        self._own, self._around = own, around
        self.left = MOST_CHARACTERS

    def of(self, name: str, line: tuple[str, ...]) -> str:
        """The value of a variable that others in a line are made of."""
        if name in line:
            raise _InvalidError
        word = self._own.get(name, "").strip().lower()
        if name in self._own and word not in ("inherit", "unset", "revert", "revert-layer"):
            if word == "initial":
                raise _InvalidError
            return _resolved(self._own[name], self, (*line, name))
        if self._around.get(name, "initial") == "initial":
            raise _InvalidError
        return self._around[name]


def _resolved(text: str, values: _Values, line: tuple[str, ...]) -> str:
    if len(line) > 64:
        raise _InvalidError
    values.left -= len(text)
    if values.left < 0:
        raise _InvalidError
    if not uses_variables(text):
        return text
    return _written(tinycss2.parse_component_value_list(text), values, line)


def _written(tokens: Sequence[Any], values: _Values, line: tuple[str, ...]) -> str:
    parts: list[str] = []
    for token in tokens:
        if token.type == "function" and token.lower_name == "var":
            # A comment keeps what stands side by side from becoming one word.
            parts.append(f"/**/{_value_of(token.arguments, values, line)}/**/")
        elif token.type == "function":
            parts.append(f"{token.name}({_written(token.arguments, values, line)})")
        elif token.type == "() block":
            parts.append(f"({_written(token.content, values, line)})")
        else:
            parts.append(tinycss2.serialize([token]))
    return "".join(parts)


def _value_of(arguments: Sequence[Any], values: _Values, line: tuple[str, ...]) -> str:
    """What `var()` stands for: a variable, or what is behind the first comma."""
    commas = [index for index, token in enumerate(arguments) if token == ","]
    end = commas[0] if commas else len(arguments)
    names = [each for each in arguments[:end] if each.type not in ("whitespace", "comment")]
    if len(names) != 1 or names[0].type != "ident" or not names[0].value.startswith("--"):
        raise _InvalidError
    fallback = arguments[end + 1 :] if commas else None
    try:
        return values.of(names[0].value, line)
    except _InvalidError:
        if fallback is None or values.left < 0 or names[0].value in line:
            raise
        return _written(fallback, values, line)
