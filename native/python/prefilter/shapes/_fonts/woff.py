# SPDX-License-Identifier: GPL-3.0-or-later

"""Fonts compressed as WOFF: unpacked within limits, as a drawing may hold any."""

import struct
import zlib

MOST_BYTES = 1 << 26
_HEADER = struct.Struct(">4s4sIHHIHHIIIII")
_ENTRY = struct.Struct(">4sIIII")
_SFNT = (b"\x00\x01\x00\x00", b"OTTO", b"true", b"ttcf")


class DamagedFontError(ValueError):
    """Bytes that are no font; the message says why."""


def as_sfnt(data: bytes) -> bytes:
    """A TrueType or OpenType font that is WOFF, or itself.

    Raises:
        DamagedFontError: It is neither.
    """
    if data[:4] in _SFNT:
        return data
    if data[:4] == b"wOF2":
        raise DamagedFontError("it is WOFF 2")
    if data[:4] != b"wOFF" or len(data) < _HEADER.size:
        raise DamagedFontError("it is neither TrueType, OpenType nor WOFF")
    flavor, count = data[4:8], int.from_bytes(data[12:14], "big")
    if len(data) < _HEADER.size + count * _ENTRY.size:
        raise DamagedFontError("it ends early")
    head = bytearray(struct.pack(">4sHHHH", flavor, count, *_search(count)))
    body = bytearray()
    begin = len(head) + 16 * count
    left = MOST_BYTES
    for index in range(count):
        tag, offset, packed, size, checksum = _ENTRY.unpack_from(
            data, _HEADER.size + index * _ENTRY.size
        )
        left -= size
        if left < 0:
            raise DamagedFontError(f"it is larger than {MOST_BYTES >> 20} MiB when unpacked")
        table = _unpacked(data[offset : offset + packed], size)
        head += struct.pack(">4sIII", tag, checksum, begin + len(body), size)
        body += table + bytes(-len(table) % 4)
    return bytes(head + body)


def _search(count: int) -> tuple[int, int, int]:
    """What a font says for a search among its tables."""
    steps = max(count, 1).bit_length() - 1
    return 16 << steps, steps, 16 * count - (16 << steps)


def _unpacked(data: bytes, size: int) -> bytes:
    if len(data) == size:
        return data
    try:
        found = zlib.decompressobj().decompress(data, size + 1)
    except zlib.error as error:
        raise DamagedFontError(f"it is damaged: {error}") from None
    if len(found) != size:
        raise DamagedFontError("its tables have other sizes than it says")
    return found
