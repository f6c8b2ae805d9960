# SPDX-License-Identifier: GPL-3.0-or-later

"""Evaluation of filters on pixels: W3C, Filter Effects Level 1.

Images are (height, width, 4) with row 0 at the bottom, colors premultiplied by alpha.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt

from ....images.color import to_linear, to_srgb
from ...affine import Matrix, compose, inverse
from ..model.blending import blend, straight_colors
from ..model.limits import TooLargeError
from ..model.tree import Box, Filter, Group, Step, transform_box
from .lighting import light_surface
from .neighborhoods import apply_morphology, convolve, repeat_tile
from .pixels import apply_color_matrix, blur, composite, shift, transfer_components
from .turbulence import noise

FloatArray = npt.NDArray[np.float32]
Slices = tuple[slice, slice]
"""Rows and columns."""

MAX_KEPT = 64
"""Results kept for later steps; each is as large as the layer."""
_PIXELS_PER_NOISE_BATCH = 1 << 16


@dataclass
class _Result:
    """Pixels of a step, whether their colors are decoded, and the step's subregion."""

    pixels: FloatArray
    is_linear: bool
    region: Slices


def filter_reach(filter_: Filter, matrix: Matrix) -> float:
    """Returns how far pixels depend on others, in pixels; `matrix` leads to them from the tree."""
    matrix = compose(matrix, filter_.matrix)
    total = 0.0
    for step in filter_.steps:
        if step.kind in ("feGaussianBlur", "feDropShadow"):
            total += 3.0 * max(_lengths(step.numbers[:2], matrix))
        if step.kind == "feMorphology":
            total += max(_lengths(step.numbers[:2], matrix))
        if step.kind == "feOffset":
            total += sum(map(abs, _direction(step.numbers, matrix)))
        if step.kind == "feDropShadow":
            total += sum(map(abs, _direction(step.numbers[2:4], matrix)))
        if step.kind == "feConvolveMatrix":
            total += max(step.numbers[:2])
    return total + 1.0


def apply_filter(
    draw: Callable[[Group], FloatArray],
    group: Group,
    filter_: Filter,
    matrix: Matrix,
    window: tuple[int, int, int, int],
) -> FloatArray:
    """Applies a filter to a group.

    Args:
        draw: Returns the pixels of a group's contents.
        matrix: From the filter's units to pixels, with rotations by right angles only.
        window: Pixels to return: left, low, right, high.
    """
    return _FilterRun(draw, group, filter_, matrix, window).result()


class _FilterRun:
    """The steps of a filter, with the results so far."""

    def __init__(
        self,
        draw: Callable[[Group], FloatArray],
        group: Group,
        filter_: Filter,
        matrix: Matrix,
        window: tuple[int, int, int, int],
    ) -> None:
        left, low, right, high = window
        self._draw = draw
        self._filter = filter_
        self._matrix = matrix
        self._corner = left, low
        self._shape = high - low, right - left
        # From the filter's units to pixels of the window, y downwards from its top.
        self._down = compose((1.0, 0.0, 0.0, -1.0, -left, high), matrix)
        self._region = self._slices(filter_.region)
        self._source = _cut(draw(group), self._region)
        alpha = np.zeros_like(self._source)
        alpha[..., 3] = self._source[..., 3]
        is_linear = filter_.is_linear
        self._last = _Result(self._source, is_linear, self._region)
        self._named = {
            "SourceGraphic": self._last,
            "SourceAlpha": _Result(alpha, is_linear, self._region),
        }

    def result(self) -> FloatArray:
        """Returns the last step's result, in the layer's color encoding."""
        if not self._filter.steps:
            return np.zeros_like(self._source)
        for index, step in enumerate(self._filter.steps):
            inputs = [self._named.get(name, self._last) for name in step.inputs]
            region = self._region_of(step, inputs)
            # The contents of `feImage` are drawn in the layer's encoding.
            is_linear = self._filter.is_linear if step.kind == "feImage" else step.is_linear
            pixels = self._evaluate(step, inputs, region)
            self._last = _Result(_cut(pixels, region), is_linear, region)
            if step.result:
                self._named[step.result] = self._last
            self._forget(index)
        return _with_colors(self._last, self._filter.is_linear)

    def _forget(self, index: int) -> None:
        """Drops results that no later step reads."""
        read = {name for step in self._filter.steps[index + 1 :] for name in step.inputs}
        self._named = {name: kept for name, kept in self._named.items() if name in read}
        if len(self._named) > MAX_KEPT:
            raise TooLargeError(f"a filter keeps the results of more than {MAX_KEPT} steps")

    def _region_of(self, step: Step, inputs: list[_Result]) -> Slices:
        """Returns a step's subregion: its own, or the union of its inputs'."""
        if step.region is not None:
            return _intersect(self._region, self._slices(step.region))
        if not inputs or step.kind == "feTile":
            return self._region
        rows, columns = (
            slice(min(part.start for part in parts), max(part.stop for part in parts))
            for parts in zip(*(each.region for each in inputs), strict=True)
        )
        return rows, columns

    def _evaluate(self, step: Step, inputs: list[_Result], region: Slices) -> FloatArray:
        if step.kind == "feMerge":
            return self._merge(inputs, step.is_linear)
        images = [_with_colors(each, step.is_linear) for each in inputs]
        numbers = step.numbers
        match step.kind:
            case "feGaussianBlur":
                return blur(images[0], *_lengths(numbers, self._matrix))
            case "feOffset":
                return shift(images[0], *_direction(numbers, self._matrix))
            case "feFlood":
                return self._flood(numbers, step.is_linear)
            case "feDropShadow":
                return self._drop_shadow(step, images[0])
            case "feComposite":
                return composite(images[0], images[1], step.name, numbers)
            case "feBlend":
                return blend(images[1].copy(), images[0], step.name)
            case "feColorMatrix":
                return apply_color_matrix(images[0], np.array(numbers, np.float32).reshape(4, 5))
            case "feComponentTransfer":
                return transfer_components(images[0], numbers)
            case "feTile":
                return repeat_tile(images[0], inputs[0].region, region)
            case "feMorphology":
                x, y = (math.floor(length + 0.5) for length in _lengths(numbers, self._matrix))
                return apply_morphology(images[0], x, y, is_largest=step.name == "dilate")
            case "feConvolveMatrix":
                change = partial(convolve, numbers=numbers, edge_mode=step.name)
                return self._map_region(images[0], change)
            case "feDiffuseLighting" | "feSpecularLighting":
                return self._map_region(images[0], partial(self._light, step=step))
            case "feTurbulence":
                return self._noise(step, region)
            case "feImage" if step.group is not None:
                return self._draw(step.group)
            case _:
                return np.zeros_like(self._source)

    def _map_region(
        self, pixels: FloatArray, change: Callable[[FloatArray], FloatArray]
    ) -> FloatArray:
        """Applies a function of images with the top row first to the filter region."""
        mapped = np.zeros_like(pixels)
        if pixels[self._region].size:
            mapped[self._region] = change(pixels[self._region][::-1])[::-1]
        return mapped

    def _light(self, pixels: FloatArray, step: Step) -> FloatArray:
        numbers = list(step.numbers)
        color = np.array([[numbers[3:6]]], np.float32)
        numbers[3:6] = (to_linear(color) if step.is_linear else color)[0, 0].tolist()
        a, b, c, d, e, f = self._down
        # Heights scale with the image, so that slopes are preserved.
        scale = math.sqrt((a * a + b * b + c * c + d * d) / 2.0)
        numbers[0] *= scale
        if step.name != "feDistantLight":
            rows, columns = self._region
            top = self._shape[0] - rows.stop
            for at in range(6, 6 + 3 * (len(numbers) // 3 - 2), 3):
                x, y, z = numbers[at : at + 3]
                numbers[at] = a * x + c * y + e - columns.start
                numbers[at + 1] = b * x + d * y + f - top
                numbers[at + 2] = scale * z
        alpha = pixels[..., 3].astype(np.float64)
        return light_surface(alpha, step.kind, step.name, tuple(numbers))

    def _noise(self, step: Step, region: Slices) -> FloatArray:
        pixels = np.zeros_like(self._source)
        a, b, c, d, e, f = inverse(self._down)
        rows, columns = region
        top, bottom = self._shape[0] - rows.stop, self._shape[0] - rows.start
        tile = None
        if step.numbers[4]:
            box = (float(columns.start), float(top), float(columns.stop), float(bottom))
            left, upper, right, lower = transform_box(box, (a, b, c, d, e, f))
            tile = left, upper, right - left, lower - upper
        inside = pixels[region][::-1]
        # Limits the memory of intermediate results.
        count = max(_PIXELS_PER_NOISE_BATCH // max(columns.stop - columns.start, 1), 1)
        for begin in range(0, bottom - top, count):
            part = inside[begin : begin + count]
            x, y = np.meshgrid(
                np.arange(float(columns.start), columns.stop), top + begin + np.arange(len(part))
            )
            straight = noise(
                a * x + c * y + e,
                b * x + d * y + f,
                (step.numbers[0], step.numbers[1]),
                int(step.numbers[2]),
                int(step.numbers[3]),
                is_fractal=step.name == "fractalNoise",
                tile=tile,
            )
            straight[..., :3] *= straight[..., 3:]
            part[...] = straight
        return pixels

    def _merge(self, inputs: list[_Result], is_linear: bool) -> FloatArray:
        merged = np.zeros_like(self._source)
        for each in inputs:
            merged = blend(merged, _with_colors(each, is_linear), "normal")
        return merged

    def _flood(self, color: tuple[float, ...], is_linear: bool) -> FloatArray:
        pixel = np.array([[[*(value * color[3] for value in color[:3]), color[3]]]], np.float32)
        pixel = _with_colors(_Result(pixel, False, self._region), is_linear)
        return np.broadcast_to(pixel, self._source.shape).copy()

    def _drop_shadow(self, step: Step, source: FloatArray) -> FloatArray:
        numbers = step.numbers
        deviations, move, color = numbers[:2], numbers[2:4], numbers[4:]
        alpha = blur(source[..., 3:], *_lengths(deviations, self._matrix))
        alpha = shift(alpha, *_direction(move, self._matrix))
        return blend(self._flood(color, step.is_linear) * alpha, source, "normal")

    def _slices(self, region: Box | None) -> Slices:
        """Returns the pixels that a region touches."""
        height, width = self._shape
        if region is None:
            return slice(0, height), slice(0, width)
        left, low, right, high = transform_box(region, self._matrix)
        x, y = self._corner
        begin, end = (_clamp(value - x, width) for value in (left + 1e-6, right - 1e-6))
        bottom, top = (_clamp(value - y, height) for value in (low + 1e-6, high - 1e-6))
        rows = slice(math.floor(bottom), max(math.ceil(top), math.floor(bottom)))
        return rows, slice(math.floor(begin), max(math.ceil(end), math.floor(begin)))


def _clamp(value: float, most: int) -> float:
    return min(max(value, 0.0), float(most))


def _intersect(one: Slices, other: Slices) -> Slices:
    rows, columns = (
        slice(max(a.start, b.start), max(min(a.stop, b.stop), a.start, b.start))
        for a, b in zip(one, other, strict=True)
    )
    return rows, columns


def _cut(pixels: FloatArray, region: Slices) -> FloatArray:
    """Makes pixels outside a region transparent."""
    cut = np.zeros_like(pixels)
    cut[region] = pixels[region]
    return cut


def is_upright(matrix: Matrix) -> bool:
    """Returns whether a matrix rotates by right angles only."""
    a, b, c, d = map(abs, matrix[:4])
    return max(b, c) <= 1e-9 * max(a, d) or max(a, d) <= 1e-9 * max(b, c)


def _lengths(lengths: tuple[float, ...], matrix: Matrix) -> tuple[float, float]:
    """Converts lengths along x and y to pixels."""
    a, b, c, d = matrix[:4]
    x, y = lengths[0] * math.sqrt(a * a + b * b), lengths[1] * math.sqrt(c * c + d * d)
    return (x, y) if abs(a) >= abs(b) else (y, x)


def _direction(move: tuple[float, ...], matrix: Matrix) -> tuple[float, float]:
    a, b, c, d = matrix[:4]
    return a * move[0] + c * move[1], b * move[0] + d * move[1]


def _with_colors(result: _Result, is_linear: bool) -> FloatArray:
    """Returns pixels with decoded or encoded colors."""
    pixels = result.pixels
    if result.is_linear == is_linear:
        return pixels
    converted = pixels.copy()
    colors = straight_colors(pixels)
    changed = to_linear(colors) if is_linear else to_srgb(colors)
    converted[..., :3] = changed * pixels[..., 3:]
    return converted
