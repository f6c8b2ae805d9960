# SPDX-License-Identifier: GPL-3.0-or-later

"""A font made in code: TrueType, of one letter."""

import struct
from collections.abc import Sequence
from pathlib import Path

Points = Sequence[tuple[int, int]]

_UNITS = 1000


def write_font(path: Path, letter: str, contours: Sequence[Points]) -> None:
    """Writes a font that has a letter of these polygons, a thousand units to its size."""
    outline, box = _glyph(contours)
    tables = {
        b"cmap": _character_map(ord(letter)),
        b"glyf": outline,
        b"head": struct.pack(
            ">IIIIHHQQ4hHHhhh",
            *(0x10000, 0x10000, 0, 0x5F0F3CF5, 0, _UNITS, 0, 0, *box, 0, 8, 2, 1, 0),
        ),
        b"hhea": struct.pack(">I3hH11hH", 0x10000, 800, -200, 0, _UNITS, *(0,) * 11, 2),
        b"hmtx": struct.pack(">HhHh", _UNITS, 0, _UNITS, 0),
        # The glyph of all other letters is empty.
        b"loca": struct.pack(">3I", 0, 0, len(outline)),
        b"maxp": struct.pack(
            ">IH13H",
            *(0x10000, 2, sum(map(len, contours)), len(contours), 0, 0, 1, *(0,) * 8),
        ),
        b"name": _names("Test", "Regular"),
    }
    at = 12 + 16 * len(tables)
    entries, contents = b"", b""
    for name, table in tables.items():
        padded = table + bytes(-len(table) % 4)
        sums = sum(struct.unpack(f">{len(padded) // 4}I", padded)) & 0xFFFFFFFF
        entries += name + struct.pack(">III", sums, at + len(contents), len(table))
        contents += padded
    header = struct.pack(">IHHHH", 0x10000, len(tables), 128, 3, 16 * len(tables) - 128)
    path.write_bytes(header + entries + contents)


def _glyph(contours: Sequence[Points]) -> tuple[bytes, tuple[int, int, int, int]]:
    points = [point for contour in contours for point in contour]
    xs, ys = zip(*points, strict=True)
    box = (min(xs), min(ys), max(xs), max(ys))
    data = struct.pack(">5h", len(contours), *box)
    end = -1
    for contour in contours:
        end += len(contour)
        data += struct.pack(">H", end)
    # No instructions; every point is on its contour, and both its steps are words.
    data += struct.pack(">H", 0) + b"\x01" * len(points)
    for values in (xs, ys):
        data += b"".join(
            struct.pack(">h", value - before)
            for before, value in zip((0, *values[:-1]), values, strict=True)
        )
    return data + bytes(-len(data) % 4), box


def _character_map(code: int) -> bytes:
    """A table of format 4: one character, and the end."""
    segments = struct.pack(">HHHHHHHHH", code, 0xFFFF, 0, code, 0xFFFF, 1 - code & 0xFFFF, 1, 0, 0)
    table = struct.pack(">HHHHHHH", 4, 14 + len(segments), 0, 4, 4, 1, 0) + segments
    return struct.pack(">HHHHI", 0, 1, 3, 1, 12) + table


def _names(*names: str) -> bytes:
    """The family and the style, without which Blender 4.3 crashes."""
    texts = [name.encode("utf-16-be") for name in names]
    records, at = b"", 0
    for number, text in enumerate(texts, 1):
        records += struct.pack(">6H", 3, 1, 0x409, number, len(text), at)
        at += len(text)
    return struct.pack(">HHH", 0, len(names), 6 + len(records)) + records + b"".join(texts)
