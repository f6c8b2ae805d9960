# SPDX-License-Identifier: GPL-3.0-or-later

"""`feTurbulence`: Perlin's noise, as Filter Effects has it, number by number."""

import math
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from .... import _native

Values = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]

_SIZE = 256
_FAR = 4096.0
_CHANNELS = 4
# Beyond it numbers have no fractions.
_FARTHEST = 2.0**53


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
    """Red, green, blue and alpha, not multiplied by it, at places.

    Args:
        x: Coordinates, in an array.
        y: Likewise.
        frequencies: Along x and y.
        octaves: How many noises are added, each twice as fine as the one before.
        seed: Of random numbers.
        is_fractal: Whether they are added as they are, about a half; else their amounts are.
        tile: Left, top, width and height of what is to be repeated without a seam; None for none.
    """
    wrap = None
    if tile is not None:
        frequencies, wrap = _fitted(frequencies, tile)
    total = np.zeros((*x.shape, _CHANNELS))
    scale = 1.0
    u, v = x * frequencies[0], y * frequencies[1]
    for _ in range(octaves):
        found = _noise(u, v, seed, wrap)
        total += (found if is_fractal else np.abs(found)) / scale
        u, v, scale = 2.0 * u, 2.0 * v, 2.0 * scale
        if wrap is not None:
            width, height, right, bottom = wrap
            wrap = (2 * width, 2 * height, 2 * right - int(_FAR), 2 * bottom - int(_FAR))
    if is_fractal:
        total = 0.5 * (total + 1.0)
    found = total.clip(0.0, 1.0)
    return found


def _fitted(
    frequencies: tuple[float, float], tile: tuple[float, float, float, float]
) -> tuple[tuple[float, float], tuple[int, int, int, int]]:
    """Frequencies of which a tile has whole numbers, and where lattices begin anew."""
    found = []
    for frequency, side in zip(frequencies, tile[2:], strict=True):
        if frequency != 0.0 and side > 0.0:
            low = math.floor(side * frequency) / side
            high = math.ceil(side * frequency) / side
            frequency = low if low > 0.0 and frequency / low < high / frequency else high
        found.append(frequency)
    width, height = (
        int(side * frequency + 0.5) for frequency, side in zip(found, tile[2:], strict=True)
    )
    right = int(tile[0] * found[0]) + int(_FAR) + width
    bottom = int(tile[1] * found[1]) + int(_FAR) + height
    return (found[0], found[1]), (width, height, right, bottom)


def _noise(u: Values, v: Values, seed: int, wrap: tuple[int, int, int, int] | None) -> Values:
    order, gradients = _lattice(seed)
    corners = []
    for values, axis in ((u, 0), (v, 1)):
        moved = values + _FAR
        whole = np.floor(moved)
        first = whole.clip(-_FARTHEST, _FARTHEST).astype(np.int64)
        second = first + 1
        if wrap is not None:
            size, end = wrap[axis], wrap[axis + 2]
            first = np.where(first >= end, first - size, first)
            second = np.where(second >= end, second - size, second)
        corners.append((first % _SIZE, second % _SIZE, moved - whole))
    (x0, x1, rx), (y0, y1, ry) = corners
    i, j = order[x0], order[x1]
    sx, sy = rx * rx * (3.0 - 2.0 * rx), ry * ry * (3.0 - 2.0 * ry)
    found = np.empty((*u.shape, _CHANNELS))
    for channel in range(_CHANNELS):
        own = gradients[channel]

        def at(index: Numbers, dx: Values, dy: Values, own: Values = own) -> Values:
            gradient = own[index]
            slope: Values = dx * gradient[..., 0] + dy * gradient[..., 1]
            return slope

        top = _between(at(order[i + y0], rx, ry), at(order[j + y0], rx - 1.0, ry), sx)
        below = _between(at(order[i + y1], rx, ry - 1.0), at(order[j + y1], rx - 1.0, ry - 1.0), sx)
        found[..., channel] = _between(top, below, sy)
    return found


def _between(one: Values, other: Values, share: Values) -> Values:
    return one + share * (other - one)


@lru_cache(maxsize=16)
def _lattice(seed: int) -> tuple[Numbers, Values]:
    """The order of gradients, and those of each channel."""
    largest, factor, quotient, rest = 2147483647, 16807, 127773, 2836
    if seed <= 0:
        seed = -seed % (largest - 1) + 1
    seed = min(seed, largest - 1)

    def following(value: int) -> int:
        found = factor * (value % quotient) - rest * (value // quotient)
        return found if found > 0 else found + largest

    gradients = np.empty((_CHANNELS, 2 * _SIZE + 2, 2))
    order = list(range(_SIZE))
    for channel in range(_CHANNELS):
        for index in range(_SIZE):
            pair = []
            for _ in range(2):
                seed = following(seed)
                pair.append((seed % (2 * _SIZE) - _SIZE) / _SIZE)
            length = _native.hypot(*pair) or 1.0
            gradients[channel, index] = pair[0] / length, pair[1] / length
    for index in range(_SIZE - 1, 0, -1):
        seed = following(seed)
        other = seed % _SIZE
        order[index], order[other] = order[other], order[index]
    gradients[:, _SIZE : 2 * _SIZE] = gradients[:, :_SIZE]
    gradients[:, 2 * _SIZE :] = gradients[:, :2]
    return np.array([*order, *order, *order[:2]], np.int64), gradients
