# SPDX-License-Identifier: GPL-3.0-or-later

"""Removing dates from TIFF files: they would make two runs differ."""

import re
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

NO_DATE = "    :  :     :  :  "
"""The EXIF value of an unknown date."""
_DATE = re.compile(rb"\d{4}:\d\d:\d\d \d\d:\d\d:\d\d")
_DATES = frozenset({0x132, 0x9003, 0x9004})
_XMP, _FOLDERS = 700, frozenset({0x14A, 0x8769})
_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 7: 1, 13: 4, 16: 8, 18: 8}
_MOST_FOLDERS = 1 << 16


def remove_dates(path: Path) -> None:
    """Replaces each date of a TIFF file, in all its levels, by `NO_DATE`.

    Raises:
        OSError: The file cannot be read and written, or it is no TIFF file.
    """
    with path.open("r+b") as file:
        try:
            for start, size in list(_date_values(file)):
                file.seek(start)
                data = file.read(size)
                file.seek(start)
                file.write(_DATE.sub(NO_DATE.encode(), data))
        except (struct.error, KeyError) as error:
            raise OSError(f"'{path.name}' is no TIFF file, or damaged") from error


def _date_values(file: BinaryIO) -> Iterator[tuple[int, int]]:
    """Yields the offsets and sizes of values that may contain dates."""
    head = file.read(16)
    order = {b"II": "<", b"MM": ">"}[head[:2]]
    is_big = struct.unpack_from(f"{order}H", head, 2)[0] == 43
    word, count_code = ("Q", "Q") if is_big else ("I", "H")
    waiting = list(struct.unpack_from(order + word, head, 8 if is_big else 4))
    seen: set[int] = set()
    while waiting and len(seen) < _MOST_FOLDERS:
        start = waiting.pop()
        if start in seen or start == 0:
            continue
        seen.add(start)
        file.seek(start)
        entry = struct.Struct(f"{order}HH{word}{8 if is_big else 4}s")
        (count,) = _unpack(file, order + count_code)
        entries = [entry.unpack(file.read(entry.size)) for _ in range(count)]
        waiting += _unpack(file, order + word)
        for tag, kind, values, inline in entries:
            size = _SIZES.get(kind, 8) * values
            (offset,) = struct.unpack(order + word, inline)
            if tag in _FOLDERS:
                waiting += _offsets(file, order, word, values, offset)
            elif (tag in _DATES or tag == _XMP) and size > len(inline):
                yield offset, size


def _offsets(file: BinaryIO, order: str, word: str, values: int, offset: int) -> tuple[int, ...]:
    if values == 1:
        return (offset,)
    file.seek(offset)
    return _unpack(file, f"{order}{values}{word}")


def _unpack(file: BinaryIO, form: str) -> tuple[int, ...]:
    return struct.unpack(form, file.read(struct.calcsize(form)))
