# SPDX-License-Identifier: GPL-3.0-or-later

"""What steps of filters make of pixels: blurs, moves, mixtures and colors.

Images are (height, width, 4) with colors multiplied by alpha.
"""

import math
from decimal import Decimal

import numpy as np
import numpy.typing as npt

from .... import _native
from ..model.blending import blend, straight_colors

FloatArray = npt.NDArray[np.float32]

_ONE = np.float32(1.0)
# From here on a blur is three means, as the recommendation has it.
_LARGE_BLUR = 2.0
_STRIP = 32


def blurred(pixels: FloatArray, x: float, y: float) -> FloatArray:
    """Pixels through a Gaussian of these deviations."""
    for axis, deviation in ((1, x), (0, y)):
        if deviation >= _LARGE_BLUR:
            pixels = _by_means(pixels, deviation, axis)
        elif deviation > 0.0:
            pixels = _by_weights(pixels, deviation, axis)
    return pixels


def _by_weights(pixels: FloatArray, deviation: float, axis: int) -> FloatArray:
    """By a Gaussian, up to four deviations away."""
    reach = max(math.ceil(4.0 * deviation), 1)
    # Rounded alike everywhere, which exponentials of C are not.
    exponents = (Decimal(-k * k) / (2 * Decimal(deviation) ** 2) for k in range(reach + 1))
    weights = np.array([float(exponent.exp()) for exponent in exponents])
    weights /= weights[0] + 2.0 * weights[1:].sum()
    found = pixels * np.float32(weights[0])
    for k in range(1, reach + 1):
        for moved in (k, -k):
            found += np.float32(weights[k]) * _moved(pixels, moved, axis)
    return found


def _by_means(pixels: FloatArray, deviation: float, axis: int) -> FloatArray:
    """By three means of as many pixels as make nearly a Gaussian."""
    count = math.floor(deviation * 3.0 * math.sqrt(2.0 * math.pi) / 4.0 + 0.5)
    half = count // 2
    means = [(half, half)] * 3
    if count % 2 == 0:
        # Of an even number, the first two are off by half a pixel, there and back.
        means = [(half, half - 1), (half - 1, half), (half, half)]
    for before, after in means:
        pixels = _mean(pixels, before, after, axis)
    return pixels


def _mean(pixels: FloatArray, before: int, after: int, axis: int) -> FloatArray:
    """The mean over pixels beside each other; beyond the edges all is 0."""
    length = pixels.shape[axis]
    ahead, behind = min(after + 1, length), min(before, length)
    found = np.empty_like(pixels)
    # Sums are of some rows or columns at a time, as those of all take twice the memory of pixels.
    for first in range(0, pixels.shape[1 - axis], _STRIP):
        part = slice(first, first + _STRIP)
        lines = pixels[:, part].swapaxes(0, 1) if axis == 0 else pixels[part]
        sums = np.zeros((lines.shape[0], length + 1, lines.shape[2]))
        np.cumsum(lines, axis=1, dtype=np.float64, out=sums[:, 1:])
        means = np.empty_like(lines, np.float64)
        means[:, : length - ahead] = sums[:, ahead:length]
        means[:, length - ahead :] = sums[:, length:]
        means[:, behind:] -= sums[:, : length - behind]
        means /= before + after + 1
        if axis == 0:
            found[:, part] = means.swapaxes(0, 1)
        else:
            found[part] = means
    return found


def _moved(pixels: FloatArray, count: int, axis: int) -> FloatArray:
    """Pixels so many further on; what comes in is 0."""
    found = np.zeros_like(pixels)
    length = pixels.shape[axis]
    if abs(count) < length:
        into = slice(max(count, 0), length + min(count, 0))
        out_of = slice(max(-count, 0), length + min(-count, 0))
        if axis == 0:
            found[into] = pixels[out_of]
        else:
            found[:, into] = pixels[:, out_of]
    return found


def shifted(pixels: FloatArray, x: float, y: float) -> FloatArray:
    """Moved, in between by linear interpolation."""
    for axis, distance in ((1, x), (0, y)):
        whole = math.floor(distance)
        share = np.float32(distance - whole)
        moved = _moved(pixels, whole, axis)
        if share > 0.0:
            moved = (_ONE - share) * moved + share * _moved(pixels, whole + 1, axis)
        pixels = moved
    return pixels


def composited(
    above: FloatArray, below: FloatArray, name: str, factors: tuple[float, ...]
) -> FloatArray:
    """One over another by the name of an operator of `feComposite`."""
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
            return _valid(k1 * above * below + k2 * above + k3 * below + k4)
        case _:
            return blend(below.copy(), above, "normal")


def _valid(pixels: FloatArray) -> FloatArray:
    """Alpha in [0, 1], and colors from 0 to alpha."""
    pixels = pixels.clip(0.0, 1.0)
    pixels[..., :3] = np.minimum(pixels[..., :3], pixels[..., 3:])
    return pixels


def _straight(pixels: FloatArray) -> FloatArray:
    return np.concatenate([straight_colors(pixels), pixels[..., 3:].clip(0.0, 1.0)], -1)


def _multiplied(straight: FloatArray) -> FloatArray:
    straight = straight.clip(0.0, 1.0)
    straight[..., :3] *= straight[..., 3:]
    return straight


def recolored(pixels: FloatArray, matrix: FloatArray) -> FloatArray:
    """Colors by rows of red, green, blue and alpha, each of four factors and what is added."""
    straight = _straight(pixels)
    found = np.empty_like(straight)
    for row in range(4):
        value = np.full(straight.shape[:2], matrix[row, 4], np.float32)
        for column in range(4):
            value += matrix[row, column] * straight[..., column]
        found[..., row] = value
    return _multiplied(found)


def transferred(pixels: FloatArray, numbers: tuple[float, ...]) -> FloatArray:
    """Each channel by values at equal distances, by steps where their number is negative, and by
    an amplitude, an exponent and an offset where it is 0.
    """
    straight = _straight(pixels)
    at = 0
    for channel in range(4):
        count = int(numbers[at])
        values = np.array(numbers[at + 1 : at + 1 + abs(count)], np.float32)
        at += 1 + abs(count)
        place = straight[..., channel]
        if count == 0:
            amplitude, exponent, offset = numbers[at : at + 3]
            at += 3
            raised = _native.powers(place.astype(np.float64), exponent)
            straight[..., channel] = (amplitude * raised + offset).clip(0.0, 1.0)
        elif count < 0:
            index = np.minimum(np.floor(place * np.float32(-count)).astype(int), -count - 1)
            straight[..., channel] = values[index]
        elif count == 1:
            straight[..., channel] = values[0]
        else:
            scaled = place * np.float32(count - 1)
            index = np.minimum(np.floor(scaled).astype(int), count - 2)
            share = scaled - index
            straight[..., channel] = values[index] + share * (values[index + 1] - values[index])
    return _multiplied(straight)
