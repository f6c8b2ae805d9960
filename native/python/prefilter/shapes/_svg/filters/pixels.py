# SPDX-License-Identifier: GPL-3.0-or-later

"""Filter primitives that work pixel by pixel, blurs and offsets.

Images are (height, width, 4), colors premultiplied by alpha.
"""

import math
from decimal import Decimal

import numpy as np
import numpy.typing as npt

from .... import _native
from ..model.blending import blend, straight_colors

FloatArray = npt.NDArray[np.float32]

_ONE = np.float32(1.0)
# Deviation from which on a blur is three box blurs, as the recommendation has it.
_MIN_BOX_BLUR_DEVIATION = 2.0
_LINES_PER_STRIP = 32


def blur(pixels: FloatArray, x: float, y: float) -> FloatArray:
    """Applies a Gaussian blur with these deviations."""
    for axis, deviation in ((1, x), (0, y)):
        if deviation >= _MIN_BOX_BLUR_DEVIATION:
            pixels = _box_blurs(pixels, deviation, axis)
        elif deviation > 0.0:
            pixels = _gaussian_blur(pixels, deviation, axis)
    return pixels


def _gaussian_blur(pixels: FloatArray, deviation: float, axis: int) -> FloatArray:
    """Applies a Gaussian of four deviations to each side."""
    reach = max(math.ceil(4.0 * deviation), 1)
    # Decimal rounds the same everywhere, unlike exp() of C.
    exponents = (Decimal(-k * k) / (2 * Decimal(deviation) ** 2) for k in range(reach + 1))
    weights = np.array([float(exponent.exp()) for exponent in exponents])
    weights /= weights[0] + 2.0 * weights[1:].sum()
    sums = pixels * np.float32(weights[0])
    for k in range(1, reach + 1):
        for step in (k, -k):
            sums += np.float32(weights[k]) * _shift_whole(pixels, step, axis)
    return sums


def _box_blurs(pixels: FloatArray, deviation: float, axis: int) -> FloatArray:
    """Applies three box blurs that approximate a Gaussian."""
    count = math.floor(deviation * 3.0 * math.sqrt(2.0 * math.pi) / 4.0 + 0.5)
    half = count // 2
    means = [(half, half)] * 3
    if count % 2 == 0:
        # The first two boxes of even size are off center by half a pixel in opposite
        # directions.
        means = [(half, half - 1), (half - 1, half), (half, half)]
    for before, after in means:
        pixels = _box_blur(pixels, before, after, axis)
    return pixels


def _box_blur(pixels: FloatArray, before: int, after: int, axis: int) -> FloatArray:
    """Averages a window around each pixel; pixels beyond the edges are 0."""
    length = pixels.shape[axis]
    ahead, behind = min(after + 1, length), min(before, length)
    averages = np.empty_like(pixels)
    # Sums of a strip at a time: all of them would take twice the memory of the pixels.
    for first in range(0, pixels.shape[1 - axis], _LINES_PER_STRIP):
        part = slice(first, first + _LINES_PER_STRIP)
        lines = pixels[:, part].swapaxes(0, 1) if axis == 0 else pixels[part]
        sums = np.zeros((lines.shape[0], length + 1, lines.shape[2]))
        np.cumsum(lines, axis=1, dtype=np.float64, out=sums[:, 1:])
        means = np.empty_like(lines, np.float64)
        means[:, : length - ahead] = sums[:, ahead:length]
        means[:, length - ahead :] = sums[:, length:]
        means[:, behind:] -= sums[:, : length - behind]
        means /= before + after + 1
        if axis == 0:
            averages[:, part] = means.swapaxes(0, 1)
        else:
            averages[part] = means
    return averages


def _shift_whole(pixels: FloatArray, count: int, axis: int) -> FloatArray:
    """Shifts pixels by whole steps and fills with 0."""
    shifted_pixels = np.zeros_like(pixels)
    length = pixels.shape[axis]
    if abs(count) < length:
        into = slice(max(count, 0), length + min(count, 0))
        out_of = slice(max(-count, 0), length + min(-count, 0))
        if axis == 0:
            shifted_pixels[into] = pixels[out_of]
        else:
            shifted_pixels[:, into] = pixels[:, out_of]
    return shifted_pixels


def shift(pixels: FloatArray, x: float, y: float) -> FloatArray:
    """Shifts pixels, with linear interpolation."""
    for axis, distance in ((1, x), (0, y)):
        whole = math.floor(distance)
        share = np.float32(distance - whole)
        moved = _shift_whole(pixels, whole, axis)
        if share > 0.0:
            moved = (_ONE - share) * moved + share * _shift_whole(pixels, whole + 1, axis)
        pixels = moved
    return pixels


def composite(
    above: FloatArray, below: FloatArray, name: str, factors: tuple[float, ...]
) -> FloatArray:
    """Applies an operator of `feComposite`."""
    alpha_above, alpha_below = above[..., 3:], below[..., 3:]
    match name:
        case "in":
            return above * alpha_below
        case "out":
            return above * (_ONE - alpha_below)
        case "atop":
            return above * alpha_below + below * (_ONE - alpha_above)
        case "xor":
            return above * (_ONE - alpha_below) + below * (_ONE - alpha_above)
        case "lighter":
            total: FloatArray = np.minimum(above + below, _ONE)
            return total
        case "arithmetic":
            k1, k2, k3, k4 = map(np.float32, factors)
            return _limit(k1 * above * below + k2 * above + k3 * below + k4)
        case _:
            return blend(below.copy(), above, "normal")


def _limit(pixels: FloatArray) -> FloatArray:
    """Limits alpha to [0, 1], and colors to [0, alpha]."""
    pixels = pixels.clip(0.0, 1.0)
    pixels[..., :3] = np.minimum(pixels[..., :3], pixels[..., 3:])
    return pixels


def _straight(pixels: FloatArray) -> FloatArray:
    return np.concatenate([straight_colors(pixels), pixels[..., 3:].clip(0.0, 1.0)], -1)


def _premultiply(straight: FloatArray) -> FloatArray:
    straight = straight.clip(0.0, 1.0)
    straight[..., :3] *= straight[..., 3:]
    return straight


def apply_color_matrix(pixels: FloatArray, matrix: FloatArray) -> FloatArray:
    """Applies a color matrix with rows of four factors and a term to add."""
    straight = _straight(pixels)
    colors = np.empty_like(straight)
    for row in range(4):
        value = np.full(straight.shape[:2], matrix[row, 4], np.float32)
        for column in range(4):
            value += matrix[row, column] * straight[..., column]
        colors[..., row] = value
    return _premultiply(colors)


def transfer_components(pixels: FloatArray, numbers: tuple[float, ...]) -> FloatArray:
    """Applies a transfer function per channel; see `primitives._transfer` for the parameters."""
    straight = _straight(pixels)
    position = 0
    for channel in range(4):
        count = int(numbers[position])
        values = np.array(numbers[position + 1 : position + 1 + abs(count)], np.float32)
        position += 1 + abs(count)
        channel_pixels = straight[..., channel]
        if count == 0:
            amplitude, exponent, offset = numbers[position : position + 3]
            position += 3
            raised = _native.powers(channel_pixels.astype(np.float64), exponent)
            straight[..., channel] = (amplitude * raised + offset).clip(0.0, 1.0)
        elif count < 0:
            index = np.minimum(
                np.floor(channel_pixels * np.float32(-count)).astype(int), -count - 1
            )
            straight[..., channel] = values[index]
        elif count == 1:
            straight[..., channel] = values[0]
        else:
            scaled = channel_pixels * np.float32(count - 1)
            index = np.minimum(np.floor(scaled).astype(int), count - 2)
            share = scaled - index
            straight[..., channel] = values[index] + share * (values[index + 1] - values[index])
    return _premultiply(straight)
