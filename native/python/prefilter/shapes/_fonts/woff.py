# SPDX-License-Identifier: GPL-3.0-or-later

"""WOFF and WOFF 2: decompression within limits, as embedded fonts are untrusted."""

import struct
import zlib
from importlib import import_module

MAX_BYTES = 1 << 26
_HEADER = struct.Struct(">4s4sIHHIHHIIIII")
_ENTRY = struct.Struct(">4sIIII")
_TOO_LARGE = f"it is larger than {MAX_BYTES >> 20} MiB when unpacked"
_WOFF2_HEADER = 48
# Few compressed bytes may become 16 MiB; brotli cannot stop within a chunk.
_CHUNK_BYTES = 16
# Table flags: an explicit tag follows; indices of `glyf` and `loca`.
_EXPLICIT_TAG, _GLYPHS = 63, (10, 11)
_SFNT = (b"\x00\x01\x00\x00", b"OTTO", b"true", b"ttcf")


class DamagedFontError(ValueError):
    """The bytes are no font; the message says why."""


def as_sfnt(data: bytes) -> bytes:
    """Converts WOFF to TrueType or OpenType; returns these unchanged.

    WOFF 2 is returned unchanged, too, for fontTools to decompress, once its size is checked.

    Raises:
        DamagedFontError: The data are no font, or too large when decompressed.
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
    head = bytearray(struct.pack(">4sHHHH", flavor, count, *_search_fields(count)))
    body = bytearray()
    begin = len(head) + 16 * count
    bytes_left = MAX_BYTES
    for index in range(count):
        tag, offset, packed, size, checksum = _ENTRY.unpack_from(
            data, _HEADER.size + index * _ENTRY.size
        )
        bytes_left -= size
        if bytes_left < 0:
            raise DamagedFontError(_TOO_LARGE)
        table = _decompress(data[offset : offset + packed], size)
        head += struct.pack(">4sIII", tag, checksum, begin + len(body), size)
        body += table + bytes(-len(table) % 4)
    return bytes(head + body)


def _search_fields(count: int) -> tuple[int, int, int]:
    """Returns searchRange, entrySelector and rangeShift for a number of tables."""
    steps = max(count, 1).bit_length() - 1
    return 16 << steps, steps, 16 * count - (16 << steps)


def _check_woff2(data: bytes) -> None:
    """Raises DamagedFontError if a font is too large, without decompressing all of it."""
    try:
        brotli = import_module("brotli")
    except ImportError:
        raise DamagedFontError("WOFF 2 needs the Python package brotli") from None
    begin = _WOFF2_HEADER + _directory_size(data)
    packed = data[begin : begin + int.from_bytes(data[20:24], "big")]
    decompressor, bytes_left = brotli.Decompressor(), MAX_BYTES
    try:
        for position in range(0, len(packed), _CHUNK_BYTES):
            bytes_left -= len(decompressor.process(packed[position : position + _CHUNK_BYTES]))
            if bytes_left < 0:
                raise DamagedFontError(_TOO_LARGE)
    except brotli.error as error:
        raise DamagedFontError(f"it is damaged: {error}") from None


def _directory_size(data: bytes) -> int:
    """Returns the size of a WOFF 2 table directory, in bytes."""
    position = _WOFF2_HEADER
    for _ in range(int.from_bytes(data[12:14], "big")):
        flags = data[position : position + 1]
        if not flags:
            raise DamagedFontError("it ends early")
        kind, version = flags[0] & 0x3F, flags[0] >> 6
        position += 1 if kind != _EXPLICIT_TAG else 5
        # Version 0 means transformed for `glyf` and `loca`, and untransformed for other tables.
        is_transformed = version != 3 if kind in _GLYPHS else version != 0
        for _ in range(2 if is_transformed else 1):
            while position < len(data) and data[position] & 0x80:
                position += 1
            position += 1
    return position - _WOFF2_HEADER


def _decompress(data: bytes, size: int) -> bytes:
    if len(data) == size:
        return data
    try:
        table = zlib.decompressobj().decompress(data, size + 1)
    except zlib.error as error:
        raise DamagedFontError(f"it is damaged: {error}") from None
    if len(table) != size:
        raise DamagedFontError("its tables have other sizes than it says")
    return table
