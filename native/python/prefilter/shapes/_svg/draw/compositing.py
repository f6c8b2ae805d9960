# SPDX-License-Identifier: GPL-3.0-or-later

"""From a tree to an image: runs of outlines rasterized together, and layers over each other.

Images are (height, width, 4) with row 0 at the bottom, colors multiplied by alpha.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from .... import _native
from ....images.pixel_filters import PIXEL_FILTERS
from ...affine import Matrix, inverse, multiplied
from ...rasterization import rasterize
from ...shape import Shape
from ..filters.layers import filtered_layer
from ..filters.warping import picture_pixels, tiled_pixels
from ..model.blending import blend
from ..model.limits import TooLargeError
from ..model.tree import (
    Box,
    Clip,
    Group,
    Mask,
    Painted,
    Pattern,
    Picture,
    intersect_boxes,
    transform_box,
)
from .drawing import Drawing
from .layers import LayerPlanner, PlacedItem, bounds_of, filtered_region, is_plain, leaf_count
from .outlines import ShapeBuilder

FloatArray = npt.NDArray[np.float32]
Window = tuple[int, int, int, int]
"""Pixels: left, low, right, high; the last two are not in it."""

# A pattern is drawn tile by tile up to so many outlines.
_MAX_TILED = 20_000
_MAX_TILES = 4_000
_SMALLEST_TILE, _LARGEST_TILE = 16, 2048
# Pixels: of tiles that are smaller all filters see the mean alone, to a thousandth of 1/255.
_LEAST_SEEN = 1 / 16
# Layers within layers: each holds an image.
_MAX_DEPTH = 48
MAX_LAYER_PIXELS = 1 << 32
MAX_LAYERS = 50_000
# A pattern with layers in it is drawn tile by tile up to so many tiles.
_MAX_LAYERED_TILES = 64
# What luminance is made of, of linear colors; SVG has the same for encoded ones.
_LUMINANCE = tuple(np.float32(share) for share in (0.2125, 0.7154, 0.0721))


class Compositor:
    """Draws trees.

    Args:
        filter_name: Of shapes, as of `prefilter.rasterize`.
        threads: How many to use; 0 for all processors.
        tell: Called with the fraction done; raises to stop.
    """

    def __init__(self, filter_name: str, threads: int, report: Callable[[float], None]) -> None:
        self._filter = filter_name
        self._threads = threads
        self._report = report
        self._share = 0.0
        self._reach = next(found.radius for found in PIXEL_FILTERS if found.name == filter_name)
        self._layering = LayerPlanner()
        self._outlining = ShapeBuilder()
        self._depth = 0
        self._pixels_left = MAX_LAYER_PIXELS
        self._layers_left = MAX_LAYERS

    def draw(
        self, drawing: Drawing, matrix: Matrix, size: tuple[int, int], around: tuple[Clip, ...]
    ) -> FloatArray:
        """Draws a drawing.

        Args:
            drawing: The drawing.
            matrix: From its units to pixels, with y upwards.
            size: Width and height of the image.
            around: What all of it is cut off at.

        Raises:
            TooLargeError: It has too many layers.
        """
        placed = list(self._layering.placed(drawing.tree, matrix, around))
        background = drawing.background_in(matrix)
        below = [background] if background is not None else []
        return self._painted(self._telling(placed), (0, 0, *size), below)

    def _telling(self, placed: list[PlacedItem]) -> Iterator[PlacedItem]:
        for index, each in enumerate(placed):
            self._share = index / len(placed)
            self._report(self._share)
            yield each

    def _painted(
        self, placed: Iterable[PlacedItem], window: Window, below: Sequence[Shape] = ()
    ) -> FloatArray:
        """Items over each other, and over shapes."""
        canvas = self._blank(window)
        run = list(below)
        for each in placed:
            if is_plain(each.item):
                assert isinstance(each.item, Painted)
                shape = self._outlining.shape(each.item, each.matrix, each.opacity, each.around)
                if shape is not None:
                    run.append(shape)
                continue
            self._put_shapes(run, canvas, window)
            run = []
            part = self._part(each, window)
            if part is not None:
                layer = self._layer(each, part)
                mode = each.item.blend if isinstance(each.item, Group) else "normal"
                _put(canvas, window, layer, part, mode)
        self._put_shapes(run, canvas, window)
        return canvas

    def _blank(self, window: Window) -> FloatArray:
        self._take(window)
        return np.zeros((window[3] - window[1], window[2] - window[0], 4), np.float32)

    def _take(self, window: Window) -> None:
        """Counts a layer."""
        width, height = window[2] - window[0], window[3] - window[1]
        self._pixels_left -= width * height
        self._layers_left -= 1
        if self._pixels_left < 0 or self._layers_left < 0:
            raise TooLargeError(
                f"more than {MAX_LAYERS} layers, or of more than {MAX_LAYER_PIXELS} pixels"
            )

    def _put_shapes(self, shapes: list[Shape], canvas: FloatArray, window: Window) -> None:
        boxes = [shape.bounds for shape in shapes]
        corners = [(*box[0], *box[1]) for box in boxes if box is not None]
        part = window_of(corners, window, self._reach)
        if part is not None:
            _put(canvas, window, self._rasterized(shapes, part), part, "normal")

    def _rasterized(self, shapes: list[Shape], window: Window) -> FloatArray:
        left, low, right, high = window
        move = [[1.0, 0.0, -left], [0.0, 1.0, -low]]
        if left or low:
            shapes = [shape.transformed(move) for shape in shapes]
        found = rasterize(
            shapes,
            right - left,
            high - low,
            filter=cast("Any", self._filter),
            progress=self._go_on,
            threads=self._threads,
        )
        assert found.dtype == np.float32
        return found  # type: ignore[return-value]

    def _go_on(self, _: float) -> bool:
        self._report(self._share)
        return True

    def _coverage(self, shape: Shape, window: Window) -> FloatArray:
        shape = shape._with(shape._outline, shape._paint)
        shape.color = (1.0,)
        return self._rasterized([shape], window)

    def _part(self, placed: PlacedItem, window: Window) -> Window | None:
        """The part of a window that an item shows in."""
        boxes: list[Box] = []
        for box in bounds_of(placed.item):
            shown: Box | None = box
            for clip in placed.around:
                shown = intersect_boxes(shown, clip.bounds) if shown and clip.bounds else None
            if shown is not None:
                boxes.append(transform_box(shown, placed.matrix))
        return window_of(boxes, window, self._reach)

    def _layer(self, placed: PlacedItem, window: Window) -> FloatArray:
        """A group, a picture, or an outline with a pattern."""
        item = placed.item
        if isinstance(item, Group):
            return self._group(item, placed, window)
        if isinstance(item, Painted):
            shape = self._outlining.shape(item, placed.matrix, 1.0, placed.around)
        else:
            shape = self._outlining.frame(item, placed.matrix, placed.around)
        if shape is None:
            return self._blank(window)
        opacity = placed.opacity
        if isinstance(item, Picture):
            layer = self._picture(item, placed.matrix, window)
        else:
            assert isinstance(item.paint, Pattern)
            layer = self._pattern(item.paint, multiplied(placed.matrix, item.matrix), window)
            opacity *= item.paint.opacity
        layer *= np.float32(opacity) * self._coverage(shape, window)
        return layer

    def _group(self, group: Group, placed: PlacedItem, window: Window) -> FloatArray:
        inside = self._layering.placed(group, placed.matrix, placed.around)
        if group.filter is not None:
            layer = self._filtered(group, placed, window)
        else:
            layer = self._nested(inside, window)
        for mask in group.masks:
            layer *= self._mask(mask, placed.matrix, window)
        opacity = placed.opacity * group.opacity
        if opacity < 1.0:
            layer *= np.float32(opacity)
        return layer

    def _filtered(self, group: Group, placed: PlacedItem, window: Window) -> FloatArray:
        """A group after its filter, cut off at its clips after that."""
        box = filtered_region(group)
        clips = (*placed.around, *group.clips)
        if box is None:
            return self._blank(window)

        def draw(shown: Group, matrix: Matrix, part: Window) -> FloatArray:
            return self._nested(self._layering.placed(shown, matrix), part)

        self._take(window)
        layer = filtered_layer(draw, group, box, placed.matrix, window, self._threads)
        for shape in self._outlining.filtered(group, clips, placed.matrix):
            layer *= self._coverage(shape, window)
        return layer

    def _nested(self, placed: Iterable[PlacedItem], window: Window) -> FloatArray:
        if self._depth >= _MAX_DEPTH:
            raise TooLargeError(f"layers are nested more than {_MAX_DEPTH} deep")
        self._depth += 1
        layer = self._painted(placed, window)
        self._depth -= 1
        return layer

    def _mask(self, mask: Mask, matrix: Matrix, window: Window) -> FloatArray:
        layer = self._nested(self._layering.placed(mask.group, matrix), window)
        if mask.is_luminance:
            red, green, blue = (layer[..., k] * _LUMINANCE[k] for k in range(3))
            found: FloatArray = red + green + blue
        else:
            found = layer[..., 3]
        return found.clip(0.0, 1.0)[..., None]

    def _picture(self, picture: Picture, matrix: Matrix, window: Window) -> FloatArray:
        left, low, right, high = window
        moved = multiplied((1.0, 0.0, 0.0, 1.0, -left, -low), matrix)
        return picture_pixels(picture, moved, right - left, high - low, self._threads)

    def _pattern(self, pattern: Pattern, matrix: Matrix, window: Window) -> FloatArray:
        """A pattern all over a window; the matrix leads from the outline's units to pixels."""
        whole = multiplied(matrix, pattern.matrix)
        left, top, right, bottom = pattern.tile
        width, height = right - left, bottom - top
        box = transform_box((*map(float, window),), inverse(whole))  # type: ignore[arg-type]
        columns = range(math.floor((box[0] - left) / width), math.ceil((box[2] - left) / width))
        rows = range(math.floor((box[1] - top) / height), math.ceil((box[3] - top) / height))
        tiles = (columns.stop - columns.start) * (rows.stop - rows.start)
        most = min(_MAX_TILES, _MAX_TILED // max(leaf_count(pattern.group), 1))
        if not all(is_plain(each.item) for each in self._layering.placed(pattern.group, whole)):
            most = min(most, _MAX_LAYERED_TILES)
        if tiles > most:
            return self._tiled(pattern, whole, window)
        return self._nested(
            chain.from_iterable(
                self._layering.placed(
                    pattern.group,
                    multiplied(whole, (1.0, 0.0, 0.0, 1.0, column * width, row * height)),
                )
                for row in rows
                for column in columns
            ),
            window,
        )

    def _tiled(self, pattern: Pattern, whole: Matrix, window: Window) -> FloatArray:
        """The same by one tile as an image."""
        left, top, right, bottom = pattern.tile
        sides = (
            _native.hypot(*whole[:2]) * (right - left),
            _native.hypot(*whole[2:4]) * (bottom - top),
        )
        columns, rows = (min(max(math.ceil(side), _SMALLEST_TILE), _LARGEST_TILE) for side in sides)
        scale = (columns / (right - left), 0.0, 0.0, rows / (bottom - top), 0.0, 0.0)
        to_tile = multiplied(scale, (1.0, 0.0, 0.0, 1.0, -left, -top))
        tile = self._nested(self._layering.placed(pattern.group, to_tile), (0, 0, columns, rows))
        moved = multiplied(to_tile, inverse(whole))
        moved = multiplied(moved, (1.0, 0.0, 0.0, 1.0, window[0], window[1]))
        size = window[2] - window[0], window[3] - window[1]
        if max(sides) < _LEAST_SEEN:
            mean = tile.sum(axis=0, dtype=np.float64).sum(axis=0) / (columns * rows)
            return np.broadcast_to(mean.astype(np.float32), (size[1], size[0], 4)).copy()
        return tiled_pixels(tile, moved, *size, self._threads)


def window_of(boxes: Sequence[Box], window: Window, reach: float) -> Window | None:
    """The pixels of a window that see something of boxes; None where none does."""
    if not boxes:
        return None
    lefts, lows, rights, highs = zip(*boxes, strict=True)
    more = reach + 1.0
    box = (min(lefts) - more, min(lows) - more, max(rights) + more, max(highs) + more)
    seen = intersect_boxes(box, (*map(float, window),))  # type: ignore[arg-type]
    if seen is None:
        return None
    left, low, right, high = seen
    return math.floor(left), math.floor(low), math.ceil(right), math.ceil(high)


def _put(canvas: FloatArray, window: Window, layer: FloatArray, part: Window, mode: str) -> None:
    """Puts a layer over a part of a canvas."""
    rows = slice(part[1] - window[1], part[3] - window[1])
    columns = slice(part[0] - window[0], part[2] - window[0])
    canvas[rows, columns] = blend(canvas[rows, columns], layer, mode)
