# SPDX-License-Identifier: GPL-3.0-or-later

"""PNG files in memory."""

import struct
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOR_TYPES = {1: 0, 3: 2, 4: 6}
_PERCEPTUAL = b"\0"
_COMPRESSION = 3
_ROWS_AT_ONCE = 64


def encoded(pixels: NDArray[Any], *, is_srgb: bool = False) -> bytes:
    """Returns a PNG file.

    Args:
        pixels: (h, w, 1, 3 or 4) array of uint8 or uint16, row 0 at the bottom: gray, colors, or
            colors and straight alpha.
        is_srgb: Whether to say that it is sRGB-encoded, as most readers take for granted.
    """
    height, width, channels = pixels.shape
    size = pixels.dtype.itemsize
    header = struct.pack(">IIBBBBB", width, height, 8 * size, _COLOR_TYPES[channels], 0, 0, 0)
    compressor = zlib.compressobj(_COMPRESSION)
    data = [compressor.compress(rows.data) for rows in _filtered_rows(pixels)]
    data.append(compressor.flush())
    return b"".join(
        [
            _SIGNATURE,
            _chunk(b"IHDR", header),
            *([_chunk(b"sRGB", _PERCEPTUAL)] if is_srgb else []),
            _chunk(b"IDAT", b"".join(data)),
            _chunk(b"IEND", b""),
        ]
    )


def _filtered_rows(pixels: NDArray[Any]) -> Iterator[NDArray[np.uint8]]:
    """Yields bytes from the top, each row after the number of its filter, of which 0 is none."""
    height = len(pixels)
    for top in range(height, 0, -_ROWS_AT_ONCE):
        band = pixels[max(top - _ROWS_AT_ONCE, 0) : top][::-1].reshape(min(top, _ROWS_AT_ONCE), -1)
        values = band.astype(band.dtype.newbyteorder(">"), copy=False).view(np.uint8)
        rows = np.zeros((len(values), 1 + values.shape[1]), np.uint8)
        rows[:, 1:] = values
        yield rows


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
