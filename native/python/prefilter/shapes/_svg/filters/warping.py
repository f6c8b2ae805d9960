# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures and tiles of patterns, as pixels of an image see them."""

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from .... import _native
from ....images.color import to_linear
from ....images.resizing import resize
from ....sampling.resampling import resample
from ...affine import Matrix, inverse, multiplied
from ..model.tree import Picture

FloatArray = npt.NDArray[np.float32]

_PICTURE_FILTER: Final = "lanczos2"
_TILE_FILTER: Final = "mitchell"
# From here on a picture that is shrunk more in one direction is shrunk in that one first.
_UNEVEN = 1.25


def picture_pixels(
    picture: Picture, matrix: Matrix, width: int, height: int, threads: int
) -> FloatArray:
    """A picture on an image; what is beside it goes on as at its edges.

    Args:
        picture: The picture.
        matrix: From its tree's units to pixels.
        width: Of the image, in pixels.
        height: Likewise.
        threads: How many to use.
    """
    rows, columns = picture.texels.shape[:2]
    whole = multiplied(matrix, picture.matrix)
    if picture.is_pixelated and _is_enlarged(whole, columns, rows):
        return _nearest(picture, whole, width, height)
    texels = _premultiplied(picture.texels, picture.is_linear)
    texels = _evened(texels, whole, threads)
    rows, columns = texels.shape[:2]
    to_texels = multiplied((columns, 0.0, 0.0, rows, 0.0, 0.0), inverse(whole))
    return turned_pixels(texels, to_texels, width, height, threads)


def tiled_pixels(
    tile: FloatArray, to_tile: Matrix, width: int, height: int, threads: int
) -> FloatArray:
    """A tile that is repeated, on an image.

    Args:
        tile: (height, width, 4).
        to_tile: From pixels to those of the tile.
        width: Of the image, in pixels.
        height: Likewise.
        threads: How many to use.
    """
    return resample(
        tile,
        _rows(to_tile),
        width,
        height,
        filter=_TILE_FILTER,
        exact=True,
        wrap="repeat",
        premultiplied=True,
        threads=threads,
    )


def turned_pixels(
    pixels: FloatArray, to_pixels: Matrix, width: int, height: int, threads: int
) -> FloatArray:
    """An image on another one; what is beside it goes on as at its edges.

    Args:
        pixels: (height, width, 4), with colors multiplied by alpha.
        to_pixels: From pixels of the result to those of the image.
        width: Of the result, in pixels.
        height: Likewise.
        threads: How many to use.
    """
    found = resample(
        pixels,
        _rows(to_pixels),
        width,
        height,
        filter=_PICTURE_FILTER,
        exact=True,
        premultiplied=True,
        threads=threads,
    )
    # What rings leaves the range of colors.
    np.clip(found, 0.0, 1.0, out=found)
    return np.minimum(found, found[..., 3:])


def _is_enlarged(whole: Matrix, columns: int, rows: int) -> bool:
    return _native.hypot(*whole[:2]) >= columns and _native.hypot(*whole[2:4]) >= rows


def _nearest(picture: Picture, whole: Matrix, width: int, height: int) -> FloatArray:
    rows, columns = picture.texels.shape[:2]
    a, b, c, d, e, f = multiplied((columns, 0.0, 0.0, rows, 0.0, 0.0), inverse(whole))
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    column = np.floor(a * x + c * y + e).clip(0, columns - 1).astype(np.int64)
    row = np.floor(b * x + d * y + f).clip(0, rows - 1).astype(np.int64)
    return _premultiplied(picture.texels[row, column], picture.is_linear)


def _premultiplied(texels: npt.NDArray[np.uint8], is_linear: bool) -> FloatArray:
    found = texels.astype(np.float32) / np.float32(255.0)
    if is_linear:
        found[..., :3] = to_linear(found[..., :3])
    found[..., :3] *= found[..., 3:]
    return found


def _evened(texels: FloatArray, whole: Matrix, threads: int) -> FloatArray:
    """Fewer texels in the direction in which a picture is shrunk more than in the other."""
    rows, columns = texels.shape[:2]
    across = _native.hypot(*whole[:2]) / columns
    along = _native.hypot(*whole[2:4]) / rows
    least = min(across, along)
    if least >= 1.0 or max(across, along) < _UNEVEN * least:
        return texels
    most = min(max(across, along), 1.0)
    width = columns if across > along else max(1, math.ceil(columns * across / most))
    height = rows if along > across else max(1, math.ceil(rows * along / most))
    return resize(
        texels, width, height, filter=_PICTURE_FILTER, premultiplied=True, threads=threads
    )


def _rows(matrix: Matrix) -> np.ndarray:
    a, b, c, d, e, f = matrix
    return np.array([[a, c, e], [b, d, f]])
