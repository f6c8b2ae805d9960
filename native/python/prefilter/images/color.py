# SPDX-License-Identifier: GPL-3.0-or-later

"""Color encodings."""

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arrays import FloatArray, as_image, as_texels, as_threads, in_form_of


def to_linear(image: npt.ArrayLike, *, threads: int = 0) -> FloatArray:
    """Decodes sRGB values to scene-linear ones (IEC 61966-2-1).

    Negative values are decoded by symmetry. A fourth channel is alpha, and is unchanged.

    Args:
        image: (height, width, channels) or (height, width), display values, usually in [0, 1].
            uint8 is divided by 255, uint16 by 65535.
        threads: How many to use; 0 = all processors.

    Returns:
        A new float32 array of the same shape.

    Raises:
        ValueError: The image has another shape or type.
    """
    stored = as_texels("image", image)
    if stored.dtype == np.uint8:
        converted = _native.decode_bytes(stored, as_threads(threads))
    else:
        converted = _native.decode_srgb(as_image("image", stored), as_threads(threads))
    return in_form_of(image, converted)


def to_srgb(image: npt.ArrayLike, *, threads: int = 0) -> FloatArray:
    """Encodes scene-linear values as sRGB: the inverse of `to_linear`."""
    converted = _native.encode_srgb(as_image("image", image), as_threads(threads))
    return in_form_of(image, converted)


def as_light(stored: np.ndarray, srgb: bool, threads: int) -> FloatArray:
    """Returns an image as floats of light, from floats or uint16."""
    floats = as_image("image", stored)
    if not srgb:
        return floats
    if stored.dtype != np.uint16:
        raise ValueError(
            "encoding: 'srgb' requires images of uint8 or uint16; decode others with to_linear"
        )
    return to_linear(floats, threads=threads)


def as_words(level: FloatArray, srgb: bool, threads: int) -> npt.NDArray[np.uint16]:
    """Converts a level to uint16, rounded to the nearest step of 1/65535."""
    if srgb:
        level = to_srgb(level, threads=threads)
    full = np.float32(np.iinfo(np.uint16).max)
    words: npt.NDArray[np.uint16] = np.rint(np.clip(level, 0, 1) * full).astype(np.uint16)
    return words
