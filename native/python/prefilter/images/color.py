# SPDX-License-Identifier: GPL-3.0-or-later

"""Color encodings."""

import numpy.typing as npt

from .. import _native
from .._border.arrays import FloatArray, as_image, as_threads, in_form_of


def to_linear(image: npt.ArrayLike, *, threads: int = 0) -> FloatArray:
    """Decodes sRGB values to scene-linear ones (IEC 61966-2-1).

    Negative values are decoded by symmetry. A fourth channel is alpha, and stays as it is.

    Args:
        image: (height, width, channels) or (height, width), display values, usually in [0, 1].
            Bytes (uint8) stand for a 255th each, uint16 for a 65535th.
        threads: How many to use; 0 = all processors.

    Returns:
        A new float32 array of the same shape.

    Raises:
        ValueError: The image has another shape or type.
    """
    made = _native.decode_srgb(as_image("image", image), as_threads(threads))
    return in_form_of(image, made)


def to_srgb(image: npt.ArrayLike, *, threads: int = 0) -> FloatArray:
    """Encodes scene-linear values as sRGB: the inverse of `to_linear`."""
    made = _native.encode_srgb(as_image("image", image), as_threads(threads))
    return in_form_of(image, made)
