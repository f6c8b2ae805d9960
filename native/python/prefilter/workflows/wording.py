# SPDX-License-Identifier: GPL-3.0-or-later

"""Translatable sentences and common phrases of messages."""

from collections.abc import Iterable, Sequence, Sized
from typing import Self

_MOST_LISTED = 5
_SCALES = ((1e9, "billion"), (1e6, "million"))


class Sentence(str):
    """An English text that remembers its template and values, for translation.

    Attributes:
        template: The text with {} for each value.
        values: The values; sentences among them are translated too.
    """

    __slots__ = ("template", "values")
    template: str
    values: tuple[object, ...]

    def __new__(cls, template: str, *values: object) -> Self:
        """Fills in the values."""
        sentence = super().__new__(cls, template.format(*values) if values else template)
        sentence.template, sentence.values = template, values
        return sentence

    def __str__(self) -> Self:
        """Returns the sentence, so that `str` of an exception keeps its type."""
        return self


def listed(names: Iterable[str]) -> Sentence:
    """Returns quoted names with commas; for long lists, the first ones and the number of others."""
    quoted = [f"'{name}'" for name in names]
    more = len(quoted) - _MOST_LISTED
    first = ", ".join(quoted[:_MOST_LISTED])
    return Sentence("{} and {} more", first, more) if more > 0 else joined("", [first])


def joined(separator: str, parts: Sequence[str]) -> Sentence:
    """Returns texts joined by a separator."""
    return Sentence(separator.join(["{}"] * len(parts)), *parts)


def together(parts: Sequence[str]) -> str:
    """Returns texts joined by "and"."""
    return parts[0] if len(parts) == 1 else Sentence("{} and {}", parts[0], together(parts[1:]))


def counted(things: Sized, noun: str) -> Sentence:
    """Returns a count with its noun, such as "2 files"."""
    return Sentence(f"1 {noun}") if len(things) == 1 else Sentence(f"{{}} {noun}s", len(things))


def either(words: Sequence[str]) -> str:
    """Returns words joined by commas and "or"."""
    return f"{', '.join(words[:-1])} or {words[-1]}" if len(words) > 1 else "".join(words)


def amount(number: float, noun: str) -> Sentence:
    """Returns an amount with its noun, rounded if large, such as "1.6 million edges"."""
    for scale, name in _SCALES:
        if number >= scale:
            return Sentence(f"{{}} {name} {noun}s", f"{number / scale:.3g}")
    return counted(range(round(number)), noun)
