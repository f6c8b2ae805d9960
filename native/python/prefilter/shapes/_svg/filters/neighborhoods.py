# SPDX-License-Identifier: GPL-3.0-or-later

"""Steps of filters that look at the pixels around each: extremes, weighted sums, tiles."""

import numpy as np
import numpy.typing as npt

from ..model.blending import straight_colors

FloatArray = npt.NDArray[np.float32]

_PADDING = {"duplicate": "edge", "wrap": "wrap", "none": "constant"}


def extreme(pixels: FloatArray, x: int, y: int, *, is_largest: bool) -> FloatArray:
    """The largest or smallest value of each channel among so many pixels to each side.

    Beyond the edges all is 0.
    """
    pick = np.maximum if is_largest else np.minimum
    for axis, radius in ((1, x), (0, y)):
        length = pixels.shape[axis]
        radius = min(radius, length)
        if radius <= 0:
            continue
        padding = [(0, 0)] * pixels.ndim
        padding[axis] = (radius, radius)
        found = np.pad(pixels, padding)
        # Of as many as a power of two, then of two such rows that overlap.
        size, wanted = 1, 2 * radius + 1
        while size < wanted:
            step = min(size, wanted - size)
            count = found.shape[axis] - step
            found = pick(_part(found, 0, count, axis), _part(found, step, step + count, axis))
            size += step
        pixels = found
    return pixels


def _part(pixels: FloatArray, begin: int, end: int, axis: int) -> FloatArray:
    return pixels[:, begin:end] if axis == 1 else pixels[begin:end]


def convolved(pixels: FloatArray, numbers: tuple[float, ...], edge_mode: str) -> FloatArray:
    """Weighted sums: `feConvolveMatrix`.

    Args:
        pixels: The top row first, colors multiplied by alpha.
        numbers: Columns and rows of the weights, the column and row that stand for the pixel
            itself, whether alpha stays, what is added, and the weights.
        edge_mode: What is beyond the edges: "duplicate", "wrap", or "none" for transparent.
    """
    columns, rows, x, y = map(int, numbers[:4])
    keeps_alpha, bias = numbers[4] != 0.0, np.float32(numbers[5])
    weights = np.array(numbers[6:], np.float32).reshape(rows, columns)
    height, width = pixels.shape[:2]
    alpha = pixels[..., 3:]
    source = straight_colors(pixels) if keeps_alpha else pixels
    around = ((y, rows - 1 - y), (x, columns - 1 - x), (0, 0))
    padded = np.pad(source, around, _PADDING[edge_mode])  # type: ignore[call-overload]
    found = np.zeros_like(source)
    for row in range(rows):
        for column in range(columns):
            # The weights are turned half around.
            weight = weights[rows - 1 - row, columns - 1 - column]
            if weight != 0.0:
                found += weight * padded[row : row + height, column : column + width]
    if keeps_alpha:
        found = (found[..., :3] + bias).clip(0.0, 1.0) * alpha
        return np.concatenate([found, alpha], -1)
    found = (found + bias).clip(0.0, 1.0)
    found[..., :3] = np.minimum(found[..., :3], found[..., 3:])
    return found


def tiled(pixels: FloatArray, tile: tuple[slice, slice], region: tuple[slice, slice]) -> FloatArray:
    """Rows and columns of a tile, again and again all over a region."""
    found = np.zeros_like(pixels)
    inside = pixels[tile]
    if inside.size == 0:
        return found
    rows, columns = (
        np.arange(whole.start, whole.stop) - part.start
        for whole, part in zip(region, tile, strict=True)
    )
    found[region] = inside[rows % inside.shape[0]][:, columns % inside.shape[1]]
    return found
