# SPDX-License-Identifier: GPL-3.0-or-later

"""File names for data-blocks."""

import unicodedata
from collections.abc import Sequence

import bpy
from prefilter.files.file_names import portable


def clean_name(name: str) -> str:
    """Returns a file name that every system allows."""
    return portable(bpy.path.clean_name(unicodedata.normalize("NFC", name)))


def clean_names(names: Sequence[str]) -> list[str]:
    """Returns file names, numbered where two differ only by case."""
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
