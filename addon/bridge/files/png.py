"""PNG files in memory."""

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOR_TYPES = {1: 0, 3: 2, 4: 6}
_COMPRESSION = 3


def encoded(pixels: NDArray[Any]) -> bytes:
    """Returns a PNG file.

    Args:
        pixels: (h, w, 1, 3 or 4) array of uint8 or uint16, row 0 at the bottom: gray, colors, or
            colors and straight alpha.
    """
    height, width, channels = pixels.shape
    size = pixels.dtype.itemsize
    # Each row begins with the number of its filter, of which 0 is none.
    rows = np.zeros((height, 1 + width * channels * size), np.uint8)
    values = np.ascontiguousarray(pixels[::-1].astype(pixels.dtype.newbyteorder(">"), copy=False))
    rows[:, 1:] = values.view(np.uint8).reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8 * size, _COLOR_TYPES[channels], 0, 0, 0)
    data = zlib.compress(rows.data, _COMPRESSION)
    return b"".join(
        [_SIGNATURE, _chunk(b"IHDR", header), _chunk(b"IDAT", data), _chunk(b"IEND", b"")]
    )


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
