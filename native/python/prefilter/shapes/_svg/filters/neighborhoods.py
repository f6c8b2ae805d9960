# SPDX-License-Identifier: GPL-3.0-or-later

"""Filter primitives that read neighboring pixels: morphology, convolution, tiling."""

import numpy as np
import numpy.typing as npt

from ..model.blending import straight_colors

FloatArray = npt.NDArray[np.float32]

_PADDING = {"duplicate": "edge", "wrap": "wrap", "none": "constant"}


def apply_morphology(pixels: FloatArray, x: int, y: int, *, is_largest: bool) -> FloatArray:
    """Returns the largest or smallest value of each channel within x and y pixels to each side.

    Pixels beyond the edges are 0.
    """
    pick = np.maximum if is_largest else np.minimum
    for axis, radius in ((1, x), (0, y)):
        length = pixels.shape[axis]
        radius = min(radius, length)
        if radius <= 0:
            continue
        padding = [(0, 0)] * pixels.ndim
        padding[axis] = (radius, radius)
        extreme = np.pad(pixels, padding)
        # Windows double in size; the last step overlaps two of them.
        size, full_size = 1, 2 * radius + 1
        while size < full_size:
            step = min(size, full_size - size)
            count = extreme.shape[axis] - step
            extreme = pick(_part(extreme, 0, count, axis), _part(extreme, step, step + count, axis))
            size += step
        pixels = extreme
    return pixels


def _part(pixels: FloatArray, begin: int, end: int, axis: int) -> FloatArray:
    return pixels[:, begin:end] if axis == 1 else pixels[begin:end]


def convolve(pixels: FloatArray, numbers: tuple[float, ...], edge_mode: str) -> FloatArray:
    """Applies `feConvolveMatrix`.

    Args:
        pixels: Top row first, colors premultiplied by alpha.
        numbers: Columns and rows of the kernel, target column and row, whether alpha is preserved,
            bias, and weights.
        edge_mode: "duplicate", "wrap", or "none" for transparent black.
    """
    columns, rows, x, y = map(int, numbers[:4])
    keeps_alpha, bias = numbers[4] != 0.0, np.float32(numbers[5])
    weights = np.array(numbers[6:], np.float32).reshape(rows, columns)
    height, width = pixels.shape[:2]
    alpha = pixels[..., 3:]
    source = straight_colors(pixels) if keeps_alpha else pixels
    around = ((y, rows - 1 - y), (x, columns - 1 - x), (0, 0))
    padded = np.pad(source, around, _PADDING[edge_mode])  # type: ignore[call-overload]
    sums = np.zeros_like(source)
    for row in range(rows):
        for column in range(columns):
            # Convolution rotates the kernel by 180 degrees.
            weight = weights[rows - 1 - row, columns - 1 - column]
            if weight != 0.0:
                sums += weight * padded[row : row + height, column : column + width]
    if keeps_alpha:
        sums = (sums[..., :3] + bias).clip(0.0, 1.0) * alpha
        return np.concatenate([sums, alpha], -1)
    sums = (sums + bias).clip(0.0, 1.0)
    sums[..., :3] = np.minimum(sums[..., :3], sums[..., 3:])
    return sums


def repeat_tile(
    pixels: FloatArray, tile: tuple[slice, slice], region: tuple[slice, slice]
) -> FloatArray:
    """Repeats a tile all over a region."""
    filled = np.zeros_like(pixels)
    inside = pixels[tile]
    if inside.size == 0:
        return filled
    rows, columns = (
        np.arange(whole.start, whole.stop) - part.start
        for whole, part in zip(region, tile, strict=True)
    )
    filled[region] = inside[rows % inside.shape[0]][:, columns % inside.shape[1]]
    return filled
