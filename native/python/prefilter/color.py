"""Colour encodings."""

import numpy.typing as npt

from . import _native
from ._border.arrays import FloatArray, as_image, as_threads


def to_linear(image: npt.ArrayLike, *, threads: int = 0) -> FloatArray:
    """Decodes sRGB values to scene-linear ones (IEC 61966-2-1).

    Negative values are decoded by symmetry. A fourth channel is alpha, and stays as it is.

    Args:
        image: (height, width, channels), display values, usually in [0, 1].
        threads: How many to use; 0 = all processors.

    Returns:
        A new float32 array of the same shape.

    Raises:
        ValueError: The image has another shape or type.
    """
    return _native.decode_srgb(as_image("image", image), as_threads(threads))


def to_srgb(image: npt.ArrayLike, *, threads: int = 0) -> FloatArray:
    """Encodes scene-linear values as sRGB: the inverse of `to_linear`."""
    return _native.encode_srgb(as_image("image", image), as_threads(threads))
