# SPDX-License-Identifier: GPL-3.0-or-later

"""Placeholders in the paths of files to write: words in braces."""

import re
from collections.abc import Collection, Mapping

_BRACES = re.compile(r"\{\{|\}\}|\{([^{}]*)\}")


def check(argument: str, pattern: str, allowed: Collection[str]) -> None:
    """Raises ValueError for a placeholder that is not allowed.

    Args:
        argument: What the path is called in messages.
        pattern: The path; "{{" and "}}" in it stand for braces.
        allowed: The words, without braces.
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
    """Returns a path with values in the place of its placeholders; others stay as they are."""
    return _BRACES.sub(
        lambda match: match[0][0] if match[1] is None else values.get(match[1], match[0]),
        pattern,
    )


def literal(path: str) -> str:
    """Returns the pattern of a path without placeholders."""
    return path.replace("{", "{{").replace("}", "}}")


def _words(pattern: str) -> list[str]:
    return [match[1] for match in _BRACES.finditer(pattern) if match[1] is not None]
