# SPDX-License-Identifier: GPL-3.0-or-later

"""The choices of an option, as items of Blender's enumeration properties."""

import zlib
from collections.abc import Mapping

from prefilter.options.options import Choice

__all__ = ("Choice", "flag_items", "items", "number_of")


def items(choices: Mapping[str, Choice]) -> list[tuple[str, str, str, str, int]]:
    """Returns the items of an enumeration property.

    .blend files store the number of an item. It depends on the key alone, so items may be inserted
    anywhere. Expanded buttons store it in single precision, so it has 24 bits.
    """
    return [
        (key, choice.label, choice.description, "", number_of(key))
        for key, choice in choices.items()
    ]


def number_of(key: str) -> int:
    """Returns the number of an item."""
    return zlib.crc32(key.encode()) & 0xFFFFFF


def flag_items(choices: Mapping[str, Choice]) -> list[tuple[str, str, str]]:
    """Returns the items of an enumeration property with multiple selection."""
    return [(key, choice.label, choice.description) for key, choice in choices.items()]
