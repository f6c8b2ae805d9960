# SPDX-License-Identifier: GPL-3.0-or-later

"""Words that several messages share."""

from collections.abc import Iterable, Sequence, Sized

_MOST_LISTED = 5
_SCALES = ((1e9, "billion"), (1e6, "million"))


def listed(names: Iterable[str]) -> str:
    """Returns quoted names with commas between them; of many, the first and how many follow."""
    quoted = [f"'{name}'" for name in names]
    more = len(quoted) - _MOST_LISTED
    return ", ".join(quoted[:_MOST_LISTED]) + (f" and {more} more" if more > 0 else "")


def counted(things: Sized, noun: str) -> str:
    """Returns how many things there are, such as "2 files"."""
    return f"{len(things)} {noun}{'' if len(things) == 1 else 's'}"


def either(words: Sequence[str]) -> str:
    """Returns words with commas and "or" between them."""
    return f"{', '.join(words[:-1])} or {words[-1]}" if len(words) > 1 else "".join(words)


def amount(number: float, noun: str) -> str:
    """Returns how many things there are, rounded where there are very many: "1.6 million edges"."""
    for scale, name in _SCALES:
        if number >= scale:
            return f"{number / scale:.3g} {name} {noun}s"
    whole = round(number)
    return f"{whole} {noun}{'' if whole == 1 else 's'}"
