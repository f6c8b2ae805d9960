# SPDX-License-Identifier: GPL-3.0-or-later

"""Metadata embedded in picture files, parsed here because some OpenImageIO versions omit it."""

import os
import struct
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from . import png

_MOST_BYTES = 1 << 24
_EXIF = b"Exif\0\0"
_ORIENTATION, _EXIF_FOLDER, _RULE_FOLDER, _COLOR_SPACE, _RULE = 0x112, 0x8769, 0xA005, 0xA001, 1
_ADOBE_RGB_RULE, _ADOBE_RGB = b"R03", 2
_SHORT = 3
_DAMAGED = b"damaged"
_MOST_ENTRIES = 1000


@dataclass(frozen=True)
class EmbeddedMetadata:
    """Metadata embedded in a picture file.

    Attributes:
        exif: The EXIF block, a TIFF file; empty if absent.
        icc: An ICC profile that OpenImageIO may omit; empty if absent.
        chunks: The color chunks of a PNG file, by type.
    """

    exif: bytes = b""
    icc: bytes = b""
    chunks: Mapping[bytes, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class Exif:
    """Metadata in EXIF.

    Attributes:
        orientation: 1 to 8; 1 is upright.
        is_adobe_rgb: Whether colors are in Adobe RGB.
    """

    orientation: int = 1
    is_adobe_rgb: bool = False


def read_embedded(path: Path) -> EmbeddedMetadata:
    """Returns the metadata of a PNG, WebP or JPEG file; empty for other or damaged files."""
    try:
        with path.open("rb") as file:
            return read_embedded_from(file)
    except OSError:
        return EmbeddedMetadata()  # The picture reader reports the error.


def read_embedded_from(file: BinaryIO) -> EmbeddedMetadata:
    """Returns the metadata of a file that is open at its start."""
    try:
        start = file.read(12)
        file.seek(0)
        if start[:8] == png.SIGNATURE:
            chunks = png.color_chunks(file)
            return EmbeddedMetadata(chunks.get(b"eXIf", b""), _png_profile(chunks), chunks)
        if start[:4] == b"RIFF" and start[8:] == b"WEBP":
            found = dict(_riff(file))
            exif = found.get(b"EXIF", b"").removeprefix(_EXIF)
            return EmbeddedMetadata(exif, found.get(b"ICCP", b""))
        if start[:2] == b"\xff\xd8":
            return EmbeddedMetadata(_jpeg_exif(file))
    except (ValueError, struct.error):
        pass  # The picture reader reports the error.
    return EmbeddedMetadata()


def _png_profile(chunks: Mapping[bytes, bytes]) -> bytes:
    """Returns the ICC profile; `_DAMAGED` if it is damaged, as libpng then omits it."""
    if b"iCCP" not in chunks:
        return b""
    packed = chunks[b"iCCP"].partition(b"\0")[2][1:]
    try:
        return zlib.decompressobj().decompress(packed, _MOST_BYTES) or _DAMAGED
    except zlib.error:
        return _DAMAGED


def _riff(file: BinaryIO) -> Iterator[tuple[bytes, bytes]]:
    file.seek(12)
    while len(head := file.read(8)) == 8:
        kind, size = struct.unpack("<4sI", head)
        if kind in {b"EXIF", b"ICCP"} and size <= _MOST_BYTES:
            yield kind, file.read(size)
            file.seek(size % 2, os.SEEK_CUR)
        else:
            file.seek(size + size % 2, os.SEEK_CUR)


def _jpeg_exif(file: BinaryIO) -> bytes:
    file.seek(2)
    while len(head := file.read(4)) == 4:
        mark, kind, size = struct.unpack(">BBH", head)
        if mark != 0xFF or kind == 0xDA or size < 2:
            return b""
        data = file.read(size - 2)
        if kind == 0xE1 and data.startswith(_EXIF):
            return data[len(_EXIF) :]
    return b""


def exif_of(block: bytes) -> Exif:
    """Parses an EXIF block; a damaged one yields the defaults."""
    try:
        order = {b"II": "<", b"MM": ">"}[block[:2]]
        (start,) = struct.unpack_from(f"{order}I", block, 4)
        main = _entries(block, order, start)
        shown = _number(main.get(_ORIENTATION), order)
        folder = _entries(block, order, _number(main.get(_EXIF_FOLDER), order))
        rules = _entries(block, order, _number(folder.get(_RULE_FOLDER), order))
        rules |= _entries(block, order, _number(main.get(_RULE_FOLDER), order))
    except (KeyError, IndexError, struct.error):
        return Exif()
    spaces = [_number(entries.get(_COLOR_SPACE), order) for entries in (main, folder)]
    adobe = rules.get(_RULE, (0, b""))[1].startswith(_ADOBE_RGB_RULE) or _ADOBE_RGB in spaces
    return Exif(shown if 1 <= shown <= 8 else 1, adobe)


def _entries(block: bytes, order: str, start: int) -> dict[int, tuple[int, bytes]]:
    """Returns type and inline value of a directory's entries, by tag."""
    if start == 0:
        return {}
    (count,) = struct.unpack_from(f"{order}H", block, start)
    entries = {}
    for number in range(min(count, _MOST_ENTRIES)):
        tag, kind, _, value = struct.unpack_from(f"{order}HHI4s", block, start + 2 + 12 * number)
        entries[tag] = (kind, value)
    return entries


def _number(entry: tuple[int, bytes] | None, order: str) -> int:
    if entry is None:
        return 0
    return int(struct.unpack_from(f"{order}{'H' if entry[0] == _SHORT else 'I'}", entry[1])[0])
