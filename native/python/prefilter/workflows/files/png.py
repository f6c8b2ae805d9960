# SPDX-License-Identifier: GPL-3.0-or-later

"""Encoding PNG files, and reading their text and color chunks."""

import os
import struct
import zlib
from collections.abc import Iterable, Iterator, Mapping, Set
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}
_PERCEPTUAL = b"\0"
_COMPRESSION = 3
_ROWS_AT_ONCE = 64
_MOST_TEXT = 1 << 16
_COLOR_CHUNKS = frozenset({b"cICP", b"iCCP", b"sRGB", b"gAMA", b"cHRM", b"eXIf"})
_MOST_COLOR_BYTES = 1 << 24


def encoded(
    pixels: NDArray[Any],
    *,
    is_srgb: bool = False,
    texts: Mapping[str, str] | None = None,
    chunks: Iterable[tuple[bytes, bytes]] = (),
) -> bytes:
    """Returns a PNG file.

    Args:
        pixels: (h, w, 1 to 4) array of uint8 or uint16, row 0 at the bottom: gray or colors, and
            straight alpha where there are two or four.
        is_srgb: Whether to declare sRGB, which most readers assume anyway.
        texts: Key-value pairs to store; keys and values in Latin-1.
        chunks: More color chunks, as type and content.
    """
    height, width, channels = pixels.shape
    size = pixels.dtype.itemsize
    header = struct.pack(">IIBBBBB", width, height, 8 * size, _COLOR_TYPES[channels], 0, 0, 0)
    compressor = zlib.compressobj(_COMPRESSION)
    data = [compressor.compress(rows.data) for rows in _filtered_rows(pixels)]
    data.append(compressor.flush())
    return b"".join(
        [
            SIGNATURE,
            _chunk(b"IHDR", header),
            *([_chunk(b"sRGB", _PERCEPTUAL)] if is_srgb else []),
            *(_chunk(kind, content) for kind, content in chunks),
            *(_chunk(b"tEXt", _text(key, value)) for key, value in (texts or {}).items()),
            _chunk(b"IDAT", b"".join(data)),
            _chunk(b"IEND", b""),
        ]
    )


def texts(file: BinaryIO) -> dict[str, str]:
    """Returns the key-value pairs stored in a PNG file before its pixels.

    Raises:
        ValueError: The file is no PNG file, or damaged.
    """
    pairs: dict[str, str] = {}
    for _, data in _chunks(file, {b"tEXt"}, _MOST_TEXT):
        key, _, value = data.partition(b"\0")
        pairs[key.decode("latin-1")] = value.decode("latin-1")
    return pairs


def color_chunks(file: BinaryIO) -> dict[bytes, bytes]:
    """Returns the chunks of a PNG file about colors and orientation, by type.

    Raises:
        ValueError: The file is no PNG file, or damaged.
    """
    return dict(_chunks(file, _COLOR_CHUNKS, _MOST_COLOR_BYTES))


def _chunks(file: BinaryIO, kinds: Set[bytes], most: int) -> Iterator[tuple[bytes, bytes]]:
    """Yields the chunks of the given types before the pixels."""
    if file.read(len(SIGNATURE)) != SIGNATURE:
        raise ValueError("no PNG file")
    while len(head := file.read(8)) == 8:
        size, kind = struct.unpack(">I4s", head)
        if kind == b"IDAT":
            return
        if kind not in kinds:
            file.seek(size + 4, os.SEEK_CUR)
            continue
        data = file.read(min(size, most))
        if size > most or len(file.read(4)) < 4:
            break
        yield kind, data
    raise ValueError("damaged PNG file")


def _text(key: str, value: str) -> bytes:
    return key.encode("latin-1") + b"\0" + value.encode("latin-1")


def _filtered_rows(pixels: NDArray[Any]) -> Iterator[NDArray[np.uint8]]:
    """Yields bands of rows from the top, each row preceded by its filter type, 0 for none."""
    height = len(pixels)
    for top in range(height, 0, -_ROWS_AT_ONCE):
        band = pixels[max(top - _ROWS_AT_ONCE, 0) : top][::-1].reshape(min(top, _ROWS_AT_ONCE), -1)
        values = band.astype(band.dtype.newbyteorder(">"), copy=False).view(np.uint8)
        rows = np.zeros((len(values), 1 + values.shape[1]), np.uint8)
        rows[:, 1:] = values
        yield rows


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
