# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels in ETC1S, which share codebooks (KTX 2.0, section 4.1, BasisLZ)."""

import struct
from collections.abc import Sequence

import numpy as np

from .. import _native
from .._border.arguments import ProgressCallback, as_int
from .texels import rgba_bytes

_WORST, _BEST = 1, 255


def as_quality(quality: int) -> int:
    """The argument, checked."""
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
    """The levels, and what they share, as a file has them.

    Args:
        images: The levels, each uint8 or float32.
        is_encoded: Whether bytes are sRGB-encoded, so that errors count as eyes see them.
        has_alpha: Whether the fourth channel is kept.
        quality: As of `as_quality`.
        effort: As of `write_ktx2`.
        report: As of `write_ktx2`.
        threads: As of `write_ktx2`.
    """
    texels = [rgba_bytes(image, is_encoded, threads) for image in images]
    codebooks, parts = _native.compress_etc1s(
        texels, quality, has_alpha, is_encoded, effort, report, threads
    )
    endpoint_count, selector_count, *books = codebooks
    shared = struct.pack("<2H", endpoint_count, selector_count)
    shared += struct.pack("<4I", *map(len, books), 0)  # nothing is extended
    for color, alpha in parts:
        # No flags, then where each begins, and how long it is.
        shared += struct.pack("<5I", 0, 0, len(color), len(color) if alpha else 0, len(alpha))
    return [color + alpha for color, alpha in parts], shared + b"".join(books)
