# SPDX-License-Identifier: GPL-3.0-or-later

"""Placeholders, words in braces, in output paths."""

import re
from collections.abc import Collection, Mapping

_BRACES = re.compile(r"\{\{|\}\}|\{([^{}]*)\}")


def check(argument: str, pattern: str, allowed: Collection[str]) -> None:
    """Raises ValueError for unknown placeholders.

    Args:
        argument: The path's name in messages.
        pattern: The path; "{{" and "}}" in it stand for braces.
        allowed: The allowed words, without braces.
    """
    for word in _words(pattern):
        if word not in allowed:
            known = ", ".join(f"{{{each}}}" for each in allowed) or "none"
            raise ValueError(
                f"{argument}: found the placeholder {{{word}}} in '{pattern}'; allowed: {known} "
                f"(braces in names are written {{{{ and }}}})"
            )


def has(pattern: str, word: str) -> bool:
    """Tells whether a path has a placeholder."""
    return word in _words(pattern)


def filled(pattern: str, values: Mapping[str, str]) -> str:
    """Returns a path with its placeholders replaced by values; unknown ones stay."""
    return _BRACES.sub(
        lambda match: match[0][0] if match[1] is None else values.get(match[1], match[0]),
        pattern,
    )


def literal(path: str) -> str:
    """Escapes braces, so that a path has no placeholders."""
    return path.replace("{", "{{").replace("}", "}}")


def _words(pattern: str) -> list[str]:
    return [match[1] for match in _BRACES.finditer(pattern) if match[1] is not None]
