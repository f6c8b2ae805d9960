# SPDX-License-Identifier: GPL-3.0-or-later

"""Names of data-blocks as names of files."""

import re
import unicodedata
from collections.abc import Sequence

from prefilter._border.file_names import portable

_KEPT = re.compile(r"[A-Za-z0-9_-]")


def clean_name(name: str) -> str:
    """Returns the name of a data-block as one that every system allows for files.

    As Blender's own function does, it leaves only letters, digits, "-" and "_" of ASCII; other
    letters stay, of which Blender replaces some.
    """
    composed = unicodedata.normalize("NFC", name)
    return portable("".join(each if _is_kept(each) else "_" for each in composed))


def _is_kept(letter: str) -> bool:
    if letter.isascii():
        return _KEPT.fullmatch(letter) is not None
    return unicodedata.category(letter)[0] not in "CZ"


def clean_names(names: Sequence[str]) -> list[str]:
    """Returns the same of several, numbered where two are alike but for the case of letters."""
    taken: set[str] = set()
    cleaned: list[str] = []
    for name in names:
        stem, number = clean_name(name), 1
        numbered = stem
        while numbered.casefold() in taken:
            number += 1
            numbered = f"{stem}_{number}"
        taken.add(numbered.casefold())
        cleaned.append(numbered)
    return cleaned
