# SPDX-License-Identifier: GPL-3.0-or-later

"""Resampling of images and pattern tiles under affine maps."""

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from .... import _native
from ....images.color import to_linear
from ....images.resizing import resize
from ....sampling.resampling import resample
from ...affine import Matrix, as_rows, compose, inverse
from ..model.tree import Picture

FloatArray = npt.NDArray[np.float32]

_IMAGE_FILTER: Final = "lanczos2"
_TILE_FILTER: Final = "mitchell"
# Ratio of the two scales from which on an image is first shrunk in one direction alone.
_MIN_ANISOTROPY = 1.25


def draw_image_pixels(
    picture: Picture, matrix: Matrix, width: int, height: int, threads: int
) -> FloatArray:
    """Resamples an image of the tree; its edges extend outwards.

    `matrix` leads from the tree's units to pixels; `width` and `height` are in pixels.
    """
    rows, columns = picture.texels.shape[:2]
    whole = compose(matrix, picture.matrix)
    if picture.is_pixelated and _is_enlarged(whole, columns, rows):
        return _nearest(picture, whole, width, height)
    texels = _premultiplied(picture.texels, picture.is_linear)
    texels = _equalize_scales(texels, whole, threads)
    rows, columns = texels.shape[:2]
    to_texels = compose((columns, 0.0, 0.0, rows, 0.0, 0.0), inverse(whole))
    return warp_image(texels, to_texels, width, height, threads)


def fill_with_tile(
    tile: FloatArray, to_tile: Matrix, width: int, height: int, threads: int
) -> FloatArray:
    """Resamples a repeating tile; `to_tile` leads from pixels to the tile's pixels."""
    return resample(
        tile,
        as_rows(to_tile),
        width,
        height,
        filter=_TILE_FILTER,
        exact=True,
        wrap="repeat",
        premultiplied=True,
        threads=threads,
    )


def warp_image(
    pixels: FloatArray, to_pixels: Matrix, width: int, height: int, threads: int
) -> FloatArray:
    """Resamples an image under an affine map; its edges extend outwards.

    `to_pixels` leads from pixels of the result to pixels of the image; colors are premultiplied.
    """
    warped = resample(
        pixels,
        as_rows(to_pixels),
        width,
        height,
        filter=_IMAGE_FILTER,
        exact=True,
        premultiplied=True,
        threads=threads,
    )
    # Ringing leaves the range of colors.
    np.clip(warped, 0.0, 1.0, out=warped)
    return np.minimum(warped, warped[..., 3:])


def _is_enlarged(whole: Matrix, columns: int, rows: int) -> bool:
    return _native.hypot(*whole[:2]) >= columns and _native.hypot(*whole[2:4]) >= rows


def _nearest(picture: Picture, whole: Matrix, width: int, height: int) -> FloatArray:
    rows, columns = picture.texels.shape[:2]
    a, b, c, d, e, f = compose((columns, 0.0, 0.0, rows, 0.0, 0.0), inverse(whole))
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    column = np.floor(a * x + c * y + e).clip(0, columns - 1).astype(np.int64)
    row = np.floor(b * x + d * y + f).clip(0, rows - 1).astype(np.int64)
    return _premultiplied(picture.texels[row, column], picture.is_linear)


def _premultiplied(texels: npt.NDArray[np.uint8], is_linear: bool) -> FloatArray:
    colors = texels.astype(np.float32) / np.float32(255.0)
    if is_linear:
        colors[..., :3] = to_linear(colors[..., :3])
    colors[..., :3] *= colors[..., 3:]
    return colors


def _equalize_scales(texels: FloatArray, whole: Matrix, threads: int) -> FloatArray:
    """Shrinks texels in the direction with the smaller scale, until both scales are equal."""
    rows, columns = texels.shape[:2]
    across = _native.hypot(*whole[:2]) / columns
    along = _native.hypot(*whole[2:4]) / rows
    least = min(across, along)
    if least >= 1.0 or max(across, along) < _MIN_ANISOTROPY * least:
        return texels
    most = min(max(across, along), 1.0)
    width = columns if across > along else max(1, math.ceil(columns * across / most))
    height = rows if along > across else max(1, math.ceil(rows * along / most))
    return resize(texels, width, height, filter=_IMAGE_FILTER, premultiplied=True, threads=threads)
