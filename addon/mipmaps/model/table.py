# SPDX-License-Identifier: GPL-3.0-or-later

"""What a bake of a model does, as a table of text."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from prefilter.workflows.files import textures

from ..choices import CONTENTS

_HEAD = ("Image", "Size", "Objects", "Content", "Filter", "Format", "File")
_MOST_OBJECTS = 3


@dataclass(frozen=True)
class Row:
    """What is done with an image.

    Attributes:
        image: Its name.
        size: Such as "2048 x 2048".
        objects: The names of the objects whose surfaces count.
        content: What it is taken for, a key of `choices.CONTENTS`.
        uses: What shaders take of it, which says why.
        filter: The label of the filter.
        format: What the file holds.
        file: The path of the file, or of all levels; empty for none.
        sides: The width and height of level 0 in the file.
        tiles: The numbers of its tiles; none for an image without.
        remarks: More about what is done.
    """

    image: str
    size: str
    objects: tuple[str, ...]
    content: str
    uses: tuple[str, ...]
    filter: str
    format: str
    file: str
    sides: tuple[int, int]
    tiles: tuple[int, ...] = ()
    remarks: tuple[str, ...] = ()


def lines(rows: Sequence[Row]) -> list[str]:
    """Returns the lines of a table: a row an image, below it why, where there is more to say."""
    cells = [_HEAD, *(_cells(row) for row in rows)]
    widths = [max(len(line[column]) for line in cells) for column in range(len(_HEAD))]
    rule = tuple("-" * width for width in widths)
    found = [_line(_HEAD, widths), _line(rule, widths)]
    for row, line in zip(rows, cells[1:], strict=True):
        found.append(_line(line, widths))
        found += [f"    {text}" for text in _reasons(row)]
    return found


def _cells(row: Row) -> tuple[str, ...]:
    more = len(row.objects) - _MOST_OBJECTS
    objects = ", ".join(row.objects[:_MOST_OBJECTS]) + (f" and {more} more" if more > 0 else "")
    return (
        *(row.image, row.size, objects, CONTENTS[row.content].label, row.filter),
        *(row.format or "-", _shown_file(row.file) or "-"),
    )


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)).rstrip()


def _reasons(row: Row) -> list[str]:
    uses = ", ".join(row.uses) if row.uses else "no shader, so its color space decides"
    return [f"read by {uses}", *row.remarks]


def _shown_file(path: str) -> str:
    """Returns how to call a file of a row."""
    return textures.display_name(Path(path)).strip("'") if path else ""
