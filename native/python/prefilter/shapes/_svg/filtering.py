# SPDX-License-Identifier: GPL-3.0-or-later

"""What filters make of pixels: W3C, Filter Effects Level 1.

Images are (height, width, 4) with row 0 at the bottom, colors multiplied by alpha.
"""

import math
from dataclasses import dataclass
from decimal import Decimal

import numpy as np
import numpy.typing as npt

from ...images.color import to_linear, to_srgb
from .blending import blended
from .tree import Box, Filter, Step, carried
from .values import Matrix

FloatArray = npt.NDArray[np.float32]

_ONE = np.float32(1.0)
# From here on a blur is three means, as the recommendation has it.
_LARGE_BLUR = 2.0


@dataclass
class _Result:
    """Pixels, and whether their colors are decoded."""

    pixels: FloatArray
    is_linear: bool


def reach_of(filter_: Filter, matrix: Matrix) -> float:
    """How far pixels may look for others, in pixels; the matrix leads to them from the tree."""
    total = 0.0
    for step in filter_.steps:
        if step.kind == "feGaussianBlur":
            total += 3.0 * max(_lengths(step.numbers[:2], matrix))
        elif step.kind == "feOffset":
            total += sum(map(abs, _direction(step.numbers, matrix)))
        elif step.kind == "feDropShadow":
            total += 3.0 * max(_lengths(step.numbers[:2], matrix))
            total += sum(map(abs, _direction(step.numbers[2:4], matrix)))
    return total + 1.0


def filtered(
    source: FloatArray, filter_: Filter, matrix: Matrix, corner: tuple[int, int]
) -> FloatArray:
    """What a filter makes of a layer.

    Args:
        source: The layer.
        filter_: The filter.
        matrix: From the tree's units to pixels.
        corner: Where the lower left corner of the layer is, in pixels.
    """
    return _Filtering(source, filter_, matrix, corner).result()


class _Filtering:
    """The steps of a filter and what they have made so far."""

    def __init__(
        self, source: FloatArray, filter_: Filter, matrix: Matrix, corner: tuple[int, int]
    ) -> None:
        self._filter = filter_
        self._matrix = matrix
        self._corner = corner
        self._source = self._cut(source, filter_.region)
        alpha = np.zeros_like(source)
        alpha[..., 3] = self._source[..., 3]
        is_linear = filter_.is_linear
        self._last = _Result(self._source, is_linear)
        self._named = {
            "SourceGraphic": self._last,
            "SourceAlpha": _Result(alpha, is_linear),
        }

    def result(self) -> FloatArray:
        """What the last step makes, in the layer's colors."""
        if not self._filter.steps:
            return np.zeros_like(self._source)
        for step in self._filter.steps:
            inputs = [
                _with_colors(self._named.get(name, self._last), step.is_linear)
                for name in step.inputs
            ]
            made = self._cut(self._made(step, inputs), self._filter.region)
            if step.region is not None:
                made = self._cut(made, step.region)
            self._last = _Result(made, step.is_linear)
            if step.result:
                self._named[step.result] = self._last
        return _with_colors(self._last, self._filter.is_linear)

    def _made(self, step: Step, inputs: list[FloatArray]) -> FloatArray:
        match step.kind:
            case "feGaussianBlur":
                return _blurred(inputs[0], *_lengths(step.numbers, self._matrix))
            case "feOffset":
                return _shifted(inputs[0], *_direction(step.numbers, self._matrix))
            case "feFlood":
                return self._flood(step.numbers, step.is_linear)
            case "feDropShadow":
                return self._shadowed(step, inputs[0])
            case "feMerge":
                return self._merged(inputs)
            case "feComposite":
                return _composited(inputs[0], inputs[1], step.name, step.numbers)
            case "feBlend":
                return blended(inputs[1].copy(), inputs[0], step.name)
            case "feColorMatrix":
                return _recolored(inputs[0], np.array(step.numbers, np.float32).reshape(4, 5))
            case _:
                return _transferred(inputs[0], step.numbers)

    def _merged(self, inputs: list[FloatArray]) -> FloatArray:
        merged = np.zeros_like(self._source)
        for each in inputs:
            merged = blended(merged, each, "normal")
        return merged

    def _flood(self, color: tuple[float, ...], is_linear: bool) -> FloatArray:
        one = np.array([[[*(value * color[3] for value in color[:3]), color[3]]]], np.float32)
        one = _with_colors(_Result(one, False), is_linear)
        return np.broadcast_to(one, self._source.shape).copy()

    def _shadowed(self, step: Step, source: FloatArray) -> FloatArray:
        numbers = step.numbers
        blur, move, color = numbers[:2], numbers[2:4], numbers[4:]
        blurred = _blurred(source[..., 3:], *_lengths(blur, self._matrix))
        alpha = _shifted(blurred, *_direction(move, self._matrix))
        return blended(self._flood(color, step.is_linear) * alpha, source, "normal")

    def _cut(self, pixels: FloatArray, region: Box) -> FloatArray:
        """Pixels that a region of the tree touches; others are transparent."""
        left, low, right, high = carried(region, self._matrix)
        x, y = self._corner
        height, width = pixels.shape[:2]
        begin, end = (_limited(value - x, width) for value in (left + 1e-6, right - 1e-6))
        bottom, top = (_limited(value - y, height) for value in (low + 1e-6, high - 1e-6))
        found = np.zeros_like(pixels)
        columns = slice(math.floor(begin), math.ceil(end))
        rows = slice(math.floor(bottom), math.ceil(top))
        found[rows, columns] = pixels[rows, columns]
        return found


def _limited(value: float, most: int) -> float:
    return min(max(value, 0.0), float(most))


def _lengths(lengths: tuple[float, ...], matrix: Matrix) -> tuple[float, float]:
    """Along x and y, in pixels. What leads to these has no turns but of patterns."""
    a, b, c, d = matrix[:4]
    return lengths[0] * math.sqrt(a * a + b * b), lengths[1] * math.sqrt(c * c + d * d)


def _direction(move: tuple[float, ...], matrix: Matrix) -> tuple[float, float]:
    a, b, c, d = matrix[:4]
    return a * move[0] + c * move[1], b * move[0] + d * move[1]


def _with_colors(result: _Result, is_linear: bool) -> FloatArray:
    """Pixels with decoded colors, or with encoded ones."""
    pixels = result.pixels
    if result.is_linear == is_linear:
        return pixels
    found = pixels.copy()
    alpha = pixels[..., 3:]
    straight = np.zeros_like(pixels[..., :3])
    np.divide(pixels[..., :3], alpha, out=straight, where=alpha > 0.0)
    changed = to_linear(straight) if is_linear else to_srgb(straight)
    found[..., :3] = changed * alpha
    return found


def _blurred(pixels: FloatArray, x: float, y: float) -> FloatArray:
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
    sums = np.zeros_like(pixels, np.float64, shape=_longer(pixels.shape, axis))
    np.cumsum(pixels, axis=axis, dtype=np.float64, out=sums[_behind(axis)])
    at = np.arange(length)
    high = np.minimum(at + after + 1, length)
    low = np.maximum(at - before, 0)
    difference = sums.take(high, axis) - sums.take(low, axis)
    found: FloatArray = (difference / (before + after + 1)).astype(np.float32)
    return found


def _longer(shape: tuple[int, ...], axis: int) -> tuple[int, ...]:
    return tuple(side + (index == axis) for index, side in enumerate(shape))


def _behind(axis: int) -> tuple[slice, ...]:
    return tuple(slice(1, None) if index == axis else slice(None) for index in range(axis + 1))


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


def _shifted(pixels: FloatArray, x: float, y: float) -> FloatArray:
    """Moved, in between by linear interpolation."""
    for axis, distance in ((1, x), (0, y)):
        whole = math.floor(distance)
        share = np.float32(distance - whole)
        moved = _moved(pixels, whole, axis)
        if share > 0.0:
            moved = (_ONE - share) * moved + share * _moved(pixels, whole + 1, axis)
        pixels = moved
    return pixels


def _composited(
    above: FloatArray, below: FloatArray, name: str, factors: tuple[float, ...]
) -> FloatArray:
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
            return blended(below.copy(), above, "normal")


def _valid(pixels: FloatArray) -> FloatArray:
    """Alpha in [0, 1], and colors from 0 to alpha."""
    pixels = pixels.clip(0.0, 1.0)
    pixels[..., :3] = np.minimum(pixels[..., :3], pixels[..., 3:])
    return pixels


def _straight(pixels: FloatArray) -> FloatArray:
    straight = pixels.clip(0.0, 1.0)
    np.divide(pixels[..., :3], pixels[..., 3:], out=straight[..., :3], where=pixels[..., 3:] > 0.0)
    found: FloatArray = straight.clip(0.0, 1.0)
    return found


def _multiplied(straight: FloatArray) -> FloatArray:
    straight = straight.clip(0.0, 1.0)
    straight[..., :3] *= straight[..., 3:]
    return straight


def _recolored(pixels: FloatArray, matrix: FloatArray) -> FloatArray:
    straight = _straight(pixels)
    found = np.empty_like(straight)
    for row in range(4):
        value = np.full(straight.shape[:2], matrix[row, 4], np.float32)
        for column in range(4):
            value += matrix[row, column] * straight[..., column]
        found[..., row] = value
    return _multiplied(found)


def _transferred(pixels: FloatArray, numbers: tuple[float, ...]) -> FloatArray:
    """Each channel by values at equal distances, or by steps where their number is negative."""
    straight = _straight(pixels)
    at = 0
    for channel in range(4):
        count = int(numbers[at])
        values = np.array(numbers[at + 1 : at + 1 + abs(count)], np.float32)
        at += 1 + abs(count)
        place = straight[..., channel]
        if count < 0:
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
