# SPDX-License-Identifier: GPL-3.0-or-later

"""CSS variables: custom properties, and `var()`."""

from collections.abc import Mapping, Sequence
from typing import Any

import tinycss2

MAX_CHARACTERS = 1 << 16
"""Characters of a value after substitution, which nested variables could make grow without bound.
"""


class _InvalidError(Exception):
    """A variable has no valid value, or refers to itself."""


def uses_variables(text: str) -> bool:
    return "(" in text and "var(" in text.lower()


def resolve_variables(own: Mapping[str, str], inherited: Mapping[str, str]) -> dict[str, str]:
    """Resolves the custom properties of an element; those without a valid value are omitted.

    Args:
        own: Custom properties that the element declares.
        inherited: Resolved custom properties of its parent.
    """
    resolved = {name: text for name, text in inherited.items() if name not in own}
    for name, text in own.items():
        word = text.strip().lower()
        if word in ("inherit", "unset", "revert", "revert-layer"):
            if name in inherited:
                resolved[name] = inherited[name]
        elif word != "initial":
            try:
                resolved[name] = _substitute(text, _Resolver(own, inherited), (name,))
            except _InvalidError:
                resolved.pop(name, None)
    return resolved


def substitute(text: str, values: Mapping[str, str]) -> str | None:
    """Substitutes the variables in a value; returns None if one has no value."""
    try:
        return _substitute(text, _Resolver({}, values), ()).strip()
    except _InvalidError:
        return None


class _Resolver:
    def __init__(self, own: Mapping[str, str], inherited: Mapping[str, str]) -> None:
        self._own, self._inherited = own, inherited
        self.characters_left = MAX_CHARACTERS

    def value(self, name: str, path: tuple[str, ...]) -> str:
        """Returns the value of a variable; `path` are the variables that led to it."""
        if name in path:
            raise _InvalidError
        word = self._own.get(name, "").strip().lower()
        if name in self._own and word not in ("inherit", "unset", "revert", "revert-layer"):
            if word == "initial":
                raise _InvalidError
            return _substitute(self._own[name], self, (*path, name))
        if self._inherited.get(name, "initial") == "initial":
            raise _InvalidError
        return self._inherited[name]


def _substitute(text: str, values: _Resolver, path: tuple[str, ...]) -> str:
    if len(path) > 64:
        raise _InvalidError
    values.characters_left -= len(text)
    if values.characters_left < 0:
        raise _InvalidError
    if not uses_variables(text):
        return text
    return _serialize(tinycss2.parse_component_value_list(text), values, path)


def _serialize(tokens: Sequence[Any], values: _Resolver, path: tuple[str, ...]) -> str:
    parts: list[str] = []
    for token in tokens:
        if token.type == "function" and token.lower_name == "var":
            # The comment keeps adjacent tokens apart.
            parts.append(f"/**/{_evaluate_var(token.arguments, values, path)}/**/")
        elif token.type == "function":
            parts.append(f"{token.name}({_serialize(token.arguments, values, path)})")
        elif token.type == "() block":
            parts.append(f"({_serialize(token.content, values, path)})")
        else:
            parts.append(tinycss2.serialize([token]))
    return "".join(parts)


def _evaluate_var(arguments: Sequence[Any], values: _Resolver, path: tuple[str, ...]) -> str:
    """Evaluates the arguments of `var()`: a name, and a fallback after the first comma."""
    commas = [index for index, token in enumerate(arguments) if token == ","]
    end = commas[0] if commas else len(arguments)
    names = [each for each in arguments[:end] if each.type not in ("whitespace", "comment")]
    if len(names) != 1 or names[0].type != "ident" or not names[0].value.startswith("--"):
        raise _InvalidError
    fallback = arguments[end + 1 :] if commas else None
    try:
        return values.value(names[0].value, path)
    except _InvalidError:
        if fallback is None or values.characters_left < 0 or names[0].value in path:
            raise
        return _serialize(fallback, values, path)
