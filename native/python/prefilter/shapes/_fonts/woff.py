# SPDX-License-Identifier: GPL-3.0-or-later

"""Fonts compressed as WOFF and WOFF 2: unpacked within limits, as a drawing may hold any."""

import struct
import zlib
from importlib import import_module

MAX_BYTES = 1 << 26
_HEADER = struct.Struct(">4s4sIHHIHHIIIII")
_ENTRY = struct.Struct(">4sIIII")
_TOO_LARGE = f"it is larger than {MAX_BYTES >> 20} MiB when unpacked"
_WOFF2_HEADER = 48
# A few bytes may become 16 MiB, and no fewer than one can be unpacked.
_UNPACKED_AT_ONCE = 16
# Of a table's flags: its name follows, and which tables are `glyf` and `loca`.
_NAMED, _GLYPHS = 63, (10, 11)
_SFNT = (b"\x00\x01\x00\x00", b"OTTO", b"true", b"ttcf")


class DamagedFontError(ValueError):
    """Bytes that are no font; the message says why."""


def as_sfnt(data: bytes) -> bytes:
    """A TrueType or OpenType font that is WOFF, or itself.

    WOFF 2 stays as it is, as fontTools unpacks it; it is made sure that it may.

    Raises:
        DamagedFontError: It is neither, or too large when unpacked.
    """
    if data[:4] in _SFNT:
        return data
    if data[:4] == b"wOF2":
        _check_woff2(data)
        return data
    if data[:4] != b"wOFF" or len(data) < _HEADER.size:
        raise DamagedFontError("it is neither TrueType, OpenType nor WOFF")
    flavor, count = data[4:8], int.from_bytes(data[12:14], "big")
    if len(data) < _HEADER.size + count * _ENTRY.size:
        raise DamagedFontError("it ends early")
    head = bytearray(struct.pack(">4sHHHH", flavor, count, *_search(count)))
    body = bytearray()
    begin = len(head) + 16 * count
    left = MAX_BYTES
    for index in range(count):
        tag, offset, packed, size, checksum = _ENTRY.unpack_from(
            data, _HEADER.size + index * _ENTRY.size
        )
        left -= size
        if left < 0:
            raise DamagedFontError(_TOO_LARGE)
        table = _unpacked(data[offset : offset + packed], size)
        head += struct.pack(">4sIII", tag, checksum, begin + len(body), size)
        body += table + bytes(-len(table) % 4)
    return bytes(head + body)


def _search(count: int) -> tuple[int, int, int]:
    """What a font says for a search among its tables."""
    steps = max(count, 1).bit_length() - 1
    return 16 << steps, steps, 16 * count - (16 << steps)


def _check_woff2(data: bytes) -> None:
    """Raises DamagedFontError where a font is larger than allowed, before all of it is unpacked."""
    try:
        brotli = import_module("brotli")
    except ImportError:
        raise DamagedFontError("WOFF 2 needs the Python package brotli") from None
    begin = _WOFF2_HEADER + _size_of_directory(data)
    packed = data[begin : begin + int.from_bytes(data[20:24], "big")]
    unpacker, left = brotli.Decompressor(), MAX_BYTES
    try:
        for at in range(0, len(packed), _UNPACKED_AT_ONCE):
            left -= len(unpacker.process(packed[at : at + _UNPACKED_AT_ONCE]))
            if left < 0:
                raise DamagedFontError(_TOO_LARGE)
    except brotli.error as error:
        raise DamagedFontError(f"it is damaged: {error}") from None


def _size_of_directory(data: bytes) -> int:
    """How many bytes the list of tables of a WOFF 2 font has."""
    at = _WOFF2_HEADER
    for _ in range(int.from_bytes(data[12:14], "big")):
        flags = data[at : at + 1]
        if not flags:
            raise DamagedFontError("it ends early")
        kind, version = flags[0] & 0x3F, flags[0] >> 6
        at += 1 if kind != _NAMED else 5
        # `glyf` and `loca` are transformed in version 0, others in all but that.
        is_transformed = version != 3 if kind in _GLYPHS else version != 0
        for _ in range(2 if is_transformed else 1):
            while at < len(data) and data[at] & 0x80:
                at += 1
            at += 1
    return at - _WOFF2_HEADER


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
