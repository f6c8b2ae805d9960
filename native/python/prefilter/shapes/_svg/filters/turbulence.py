# SPDX-License-Identifier: GPL-3.0-or-later

"""`feTurbulence`: Perlin noise with the numbers of Filter Effects."""

import math
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from .... import _native

Values = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]

_SIZE = 256
_LATTICE_OFFSET = 4096.0
_CHANNELS = 4
# Larger doubles have no fractions.
_MAX_COORDINATE = 2.0**53


def noise(
    x: Values,
    y: Values,
    frequencies: tuple[float, float],
    octaves: int,
    seed: int,
    *,
    is_fractal: bool,
    tile: tuple[float, float, float, float] | None,
) -> Values:
    """Returns red, green, blue and straight alpha at positions.

    Args:
        octaves: Number of noise functions; each has twice the frequency of the one before.
        is_fractal: Whether noise is added around 0.5; otherwise absolute values are.
        tile: Left, top, width and height of a seamless tile; None for none.
    """
    wrap = None
    if tile is not None:
        frequencies, wrap = _fit_frequencies(frequencies, tile)
    total = np.zeros((*x.shape, _CHANNELS))
    scale = 1.0
    u, v = x * frequencies[0], y * frequencies[1]
    for _ in range(octaves):
        octave = _noise(u, v, seed, wrap)
        total += (octave if is_fractal else np.abs(octave)) / scale
        u, v, scale = 2.0 * u, 2.0 * v, 2.0 * scale
        if wrap is not None:
            width, height, right, bottom = wrap
            wrap = (
                2 * width,
                2 * height,
                2 * right - int(_LATTICE_OFFSET),
                2 * bottom - int(_LATTICE_OFFSET),
            )
    if is_fractal:
        total = 0.5 * (total + 1.0)
    octave = total.clip(0.0, 1.0)
    return octave


def _fit_frequencies(
    frequencies: tuple[float, float], tile: tuple[float, float, float, float]
) -> tuple[tuple[float, float], tuple[int, int, int, int]]:
    """Rounds frequencies to whole periods per tile; returns the lattice's periods and ends, too."""
    fitted = []
    for frequency, side in zip(frequencies, tile[2:], strict=True):
        if frequency != 0.0 and side > 0.0:
            low = math.floor(side * frequency) / side
            high = math.ceil(side * frequency) / side
            frequency = low if low > 0.0 and frequency / low < high / frequency else high
        fitted.append(frequency)
    width, height = (
        int(side * frequency + 0.5) for frequency, side in zip(fitted, tile[2:], strict=True)
    )
    right = int(tile[0] * fitted[0]) + int(_LATTICE_OFFSET) + width
    bottom = int(tile[1] * fitted[1]) + int(_LATTICE_OFFSET) + height
    return (fitted[0], fitted[1]), (width, height, right, bottom)


def _noise(u: Values, v: Values, seed: int, wrap: tuple[int, int, int, int] | None) -> Values:
    order, gradients = _lattice(seed)
    corners = []
    for values, axis in ((u, 0), (v, 1)):
        moved = values + _LATTICE_OFFSET
        whole = np.floor(moved)
        first = whole.clip(-_MAX_COORDINATE, _MAX_COORDINATE).astype(np.int64)
        second = first + 1
        if wrap is not None:
            size, end = wrap[axis], wrap[axis + 2]
            first = np.where(first >= end, first - size, first)
            second = np.where(second >= end, second - size, second)
        corners.append((first % _SIZE, second % _SIZE, moved - whole))
    (x0, x1, rx), (y0, y1, ry) = corners
    i, j = order[x0], order[x1]
    sx, sy = rx * rx * (3.0 - 2.0 * rx), ry * ry * (3.0 - 2.0 * ry)
    values_of_channels = np.empty((*u.shape, _CHANNELS))
    for channel in range(_CHANNELS):
        channel_gradients = gradients[channel]

        def gradient_slope(
            index: Numbers, dx: Values, dy: Values, channel_gradients: Values = channel_gradients
        ) -> Values:
            gradient = channel_gradients[index]
            slope: Values = dx * gradient[..., 0] + dy * gradient[..., 1]
            return slope

        top = _interpolate(
            gradient_slope(order[i + y0], rx, ry), gradient_slope(order[j + y0], rx - 1.0, ry), sx
        )
        below = _interpolate(
            gradient_slope(order[i + y1], rx, ry - 1.0),
            gradient_slope(order[j + y1], rx - 1.0, ry - 1.0),
            sx,
        )
        values_of_channels[..., channel] = _interpolate(top, below, sy)
    return values_of_channels


def _interpolate(one: Values, other: Values, share: Values) -> Values:
    return one + share * (other - one)


@lru_cache(maxsize=16)
def _lattice(seed: int) -> tuple[Numbers, Values]:
    """Returns the permutation of gradients, and the gradients of each channel."""
    largest, factor, quotient, remainder = 2147483647, 16807, 127773, 2836
    if seed <= 0:
        seed = -seed % (largest - 1) + 1
    seed = min(seed, largest - 1)

    def next_random(value: int) -> int:
        value_or_negative = factor * (value % quotient) - remainder * (value // quotient)
        return value_or_negative if value_or_negative > 0 else value_or_negative + largest

    gradients = np.empty((_CHANNELS, 2 * _SIZE + 2, 2))
    order = list(range(_SIZE))
    for channel in range(_CHANNELS):
        for index in range(_SIZE):
            pair = []
            for _ in range(2):
                seed = next_random(seed)
                pair.append((seed % (2 * _SIZE) - _SIZE) / _SIZE)
            length = _native.hypot(*pair) or 1.0
            gradients[channel, index] = pair[0] / length, pair[1] / length
    for index in range(_SIZE - 1, 0, -1):
        seed = next_random(seed)
        other = seed % _SIZE
        order[index], order[other] = order[other], order[index]
    gradients[:, _SIZE : 2 * _SIZE] = gradients[:, :_SIZE]
    gradients[:, 2 * _SIZE :] = gradients[:, :2]
    return np.array([*order, *order, *order[:2]], np.int64), gradients
