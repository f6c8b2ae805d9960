# SPDX-License-Identifier: GPL-3.0-or-later

"""A text table of a model's bake."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from prefilter.workflows.files import textures

from ..choices import CONTENTS

_HEAD = ("Image", "Size", "Objects", "Content", "Filter", "Format", "File")
_MOST_OBJECTS = 3


@dataclass(frozen=True)
class Row:
    """A description of an image's bake.

    Attributes:
        image: Its name.
        size: Its size, such as "2048 x 2048".
        objects: The names of the objects whose surfaces are used.
        content: Its content, a key of `choices.CONTENTS`.
        uses: The shader inputs that read it, from which the content follows.
        filter: The label of the filter.
        format: The label of the file's texel format.
        file: The path of the file, or of all levels; empty for none.
        sides: The width and height of level 0 in the file.
        tiles: The numbers of its tiles; empty for an image without tiles.
        remarks: Further remarks.
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
    """Returns the lines of a table: a row per image, with its uses and remarks below."""
    cells = [_HEAD, *(_cells(row) for row in rows)]
    widths = [max(len(line[column]) for line in cells) for column in range(len(_HEAD))]
    rule = tuple("-" * width for width in widths)
    text_lines = [_line(_HEAD, widths), _line(rule, widths)]
    for row, line in zip(rows, cells[1:], strict=True):
        text_lines.append(_line(line, widths))
        text_lines += [f"    {text}" for text in _reasons(row)]
    return text_lines


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
    """Returns a file's path as the table shows it."""
    return textures.display_name(Path(path)).strip("'") if path else ""
