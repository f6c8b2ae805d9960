# SPDX-License-Identifier: GPL-3.0-or-later

"""Compression of levels to ETC1S with common codebooks (KTX 2.0, section 4.1, BasisLZ)."""

import struct
from collections.abc import Sequence

import numpy as np

from .. import _native
from .._border.arguments import ProgressCallback, as_int
from .texels import rgba_bytes

_WORST, _BEST = 1, 255


def as_quality(quality: int) -> int:
    """Returns the checked argument."""
    allowed = f"{_WORST} to {_BEST} are allowed"
    number = as_int("quality", quality, allowed)
    if not _WORST <= number <= _BEST:
        raise ValueError(f"quality: {number}; {allowed}")
    return number


def compressed(
    images: Sequence[np.ndarray],
    is_encoded: bool,
    *,
    has_alpha: bool,
    quality: int,
    effort: str,
    report: ProgressCallback | None,
    threads: int,
) -> tuple[list[bytes], bytes]:
    """Returns the compressed levels, and their common global data, as stored in a file.

    Args:
        images: The levels, each uint8 or float32.
        is_encoded: Whether bytes are sRGB-encoded, so that errors are weighted perceptually.
        has_alpha: Whether the fourth channel is stored.
        quality: See `as_quality`.
        effort: See `write_ktx2`.
        report: The progress callback of `write_ktx2`.
        threads: See `write_ktx2`.
    """
    texels = [rgba_bytes(image, is_encoded, threads) for image in images]
    codebooks, parts = _native.compress_etc1s(
        texels, quality, has_alpha, is_encoded, effort, report, threads
    )
    endpoint_count, selector_count, *books = codebooks
    shared = struct.pack("<2H", endpoint_count, selector_count)
    shared += struct.pack("<4I", *map(len, books), 0)  # No extended data.
    for color, alpha in parts:
        # No flags; then offset and length of both slices.
        shared += struct.pack("<5I", 0, 0, len(color), len(color) if alpha else 0, len(alpha))
    return [color + alpha for color, alpha in parts], shared + b"".join(books)
