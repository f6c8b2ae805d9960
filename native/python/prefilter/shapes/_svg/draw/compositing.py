# SPDX-License-Identifier: GPL-3.0-or-later

"""Compositing of a tree into an image.

Runs of outlines are rasterized together; groups with layers are drawn apart and blended. Images are
(height, width, 4) with row 0 at the bottom, colors premultiplied by alpha.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from .... import _native
from ....images.filters import PIXEL_FILTERS
from ...affine import Matrix, compose, inverse, translation
from ...rasterization import rasterize
from ...shape import Shape
from ..filters.layers import Window, filtered_layer
from ..filters.warping import draw_image_pixels, fill_with_tile
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
from .layers import LayerPlanner, PlacedItem, filtered_region, is_plain, item_bounds, leaf_count
from .outlines import ShapeBuilder

FloatArray = npt.NDArray[np.float32]

# Outlines up to which a pattern is drawn tile by tile, rather than as an image.
_MAX_TILED = 20_000
_MAX_TILES = 4_000
_SMALLEST_TILE, _LARGEST_TILE = 16, 2048
# Pixels. Smaller tiles look uniform through any filter, to a thousandth of 1/255.
_MIN_RESOLVED_TILE = 1 / 16
# Nested layers, each of which holds an image.
_MAX_DEPTH = 48
MAX_LAYER_PIXELS = 1 << 32
MAX_LAYERS = 50_000
# Tiles up to which a pattern with layers is drawn tile by tile.
_MAX_LAYERED_TILES = 64
# Luminance weights, for linear colors; SVG uses them for encoded colors, too.
_LUMINANCE = tuple(np.float32(share) for share in (0.2125, 0.7154, 0.0721))


class Compositor:
    """Draws trees into images.

    Args:
        filter_name: Pixel filter of shapes; see `prefilter.rasterize`.
        threads: Number of threads; 0 for all processors.
        report: Called with the fraction done; raises an exception to stop.
    """

    def __init__(self, filter_name: str, threads: int, report: Callable[[float], None]) -> None:
        self._filter = filter_name
        self._threads = threads
        self._report = report
        self._share = 0.0
        self._reach = next(each.radius for each in PIXEL_FILTERS if each.name == filter_name)
        self._layers = LayerPlanner()
        self._shapes = ShapeBuilder()
        self._depth = 0
        self._pixels_left = MAX_LAYER_PIXELS
        self._layers_left = MAX_LAYERS

    def draw(
        self, drawing: Drawing, matrix: Matrix, size: tuple[int, int], group_clips: tuple[Clip, ...]
    ) -> FloatArray:
        """Draws a drawing into an image.

        Args:
            matrix: From the tree's units to pixels, y upwards.
            size: Width and height of the image.
            group_clips: Clips that apply to everything.

        Raises:
            TooLargeError: The drawing has too many layers.
        """
        placed = list(self._layers.placed(drawing.tree, matrix, group_clips))
        background = drawing.background_in(matrix)
        below = [background] if background is not None else []
        return self._draw_items(self._report_items(placed), (0, 0, *size), below)

    def _report_items(self, placed: list[PlacedItem]) -> Iterator[PlacedItem]:
        for index, each in enumerate(placed):
            self._share = index / len(placed)
            self._report(self._share)
            yield each

    def _draw_items(
        self, placed: Iterable[PlacedItem], window: Window, below: Sequence[Shape] = ()
    ) -> FloatArray:
        """Draws items over each other, and over shapes."""
        canvas = self._new_layer(window)
        run = list(below)
        for each in placed:
            if is_plain(each.item):
                assert isinstance(each.item, Painted)
                shape = self._shapes.shape(each.item, each.matrix, each.opacity, each.group_clips)
                if shape is not None:
                    run.append(shape)
                continue
            self._draw_run(run, canvas, window)
            run = []
            part = self._touched_part(each, window)
            if part is not None:
                layer = self._draw_layer(each, part)
                mode = each.item.blend if isinstance(each.item, Group) else "normal"
                _blend_part(canvas, window, layer, part, mode)
        self._draw_run(run, canvas, window)
        return canvas

    def _new_layer(self, window: Window) -> FloatArray:
        self._count_layer(window)
        return np.zeros((window[3] - window[1], window[2] - window[0], 4), np.float32)

    def _count_layer(self, window: Window) -> None:
        """Counts a layer."""
        width, height = window[2] - window[0], window[3] - window[1]
        self._pixels_left -= width * height
        self._layers_left -= 1
        if self._pixels_left < 0 or self._layers_left < 0:
            raise TooLargeError(
                f"more than {MAX_LAYERS} layers, or of more than {MAX_LAYER_PIXELS} pixels"
            )

    def _draw_run(self, shapes: list[Shape], canvas: FloatArray, window: Window) -> None:
        boxes = [shape.bounds for shape in shapes]
        corners = [(*box[0], *box[1]) for box in boxes if box is not None]
        part = touched_window(corners, window, self._reach)
        if part is not None:
            _blend_part(canvas, window, self._rasterize(shapes, part), part, "normal")

    def _rasterize(self, shapes: list[Shape], window: Window) -> FloatArray:
        left, low, right, high = window
        move = [[1.0, 0.0, -left], [0.0, 1.0, -low]]
        if left or low:
            shapes = [shape.transformed(move) for shape in shapes]
        image = rasterize(
            shapes,
            right - left,
            high - low,
            filter=cast("Any", self._filter),
            progress=self._keep_going,
            threads=self._threads,
        )
        assert image.dtype == np.float32
        return image  # type: ignore[return-value]

    def _keep_going(self, _: float) -> bool:
        self._report(self._share)
        return True

    def _coverage(self, shape: Shape, window: Window) -> FloatArray:
        shape = shape._with(shape._outline, shape._paint)
        shape.color = (1.0,)
        return self._rasterize([shape], window)

    def _touched_part(self, placed: PlacedItem, window: Window) -> Window | None:
        """Returns the part of a window that an item touches."""
        boxes: list[Box] = []
        for box in item_bounds(placed.item):
            shown: Box | None = box
            for clip in placed.group_clips:
                shown = intersect_boxes(shown, clip.bounds) if shown and clip.bounds else None
            if shown is not None:
                boxes.append(transform_box(shown, placed.matrix))
        return touched_window(boxes, window, self._reach)

    def _draw_layer(self, placed: PlacedItem, window: Window) -> FloatArray:
        """Draws a group, an image, or an outline with a pattern."""
        item = placed.item
        if isinstance(item, Group):
            return self._draw_group(item, placed, window)
        if isinstance(item, Painted):
            shape = self._shapes.shape(item, placed.matrix, 1.0, placed.group_clips)
        else:
            shape = self._shapes.image_area(item, placed.matrix, placed.group_clips)
        if shape is None:
            return self._new_layer(window)
        opacity = placed.opacity
        if isinstance(item, Picture):
            layer = self._draw_image(item, placed.matrix, window)
        else:
            assert isinstance(item.paint, Pattern)
            layer = self._draw_pattern(item.paint, compose(placed.matrix, item.matrix), window)
            opacity *= item.paint.opacity
        layer *= np.float32(opacity) * self._coverage(shape, window)
        return layer

    def _draw_group(self, group: Group, placed: PlacedItem, window: Window) -> FloatArray:
        inside = self._layers.placed(group, placed.matrix, placed.group_clips)
        if group.filter is not None:
            layer = self._draw_filtered(group, placed, window)
        else:
            layer = self._draw_nested(inside, window)
        for mask in group.masks:
            layer *= self._mask_coverage(mask, placed.matrix, window)
        opacity = placed.opacity * group.opacity
        if opacity < 1.0:
            layer *= np.float32(opacity)
        return layer

    def _draw_filtered(self, group: Group, placed: PlacedItem, window: Window) -> FloatArray:
        """Draws a group, applies its filter, and clips the result."""
        box = filtered_region(group)
        clips = (*placed.group_clips, *group.clips)
        if box is None:
            return self._new_layer(window)

        def draw(shown: Group, matrix: Matrix, part: Window) -> FloatArray:
            return self._draw_nested(self._layers.placed(shown, matrix), part)

        self._count_layer(window)
        layer = filtered_layer(draw, group, box, placed.matrix, window, self._threads)
        for shape in self._shapes.filter_clip(group, clips, placed.matrix):
            layer *= self._coverage(shape, window)
        return layer

    def _draw_nested(self, placed: Iterable[PlacedItem], window: Window) -> FloatArray:
        if self._depth >= _MAX_DEPTH:
            raise TooLargeError(f"layers are nested more than {_MAX_DEPTH} deep")
        self._depth += 1
        layer = self._draw_items(placed, window)
        self._depth -= 1
        return layer

    def _mask_coverage(self, mask: Mask, matrix: Matrix, window: Window) -> FloatArray:
        layer = self._draw_nested(self._layers.placed(mask.group, matrix), window)
        if mask.is_luminance:
            red, green, blue = (layer[..., k] * _LUMINANCE[k] for k in range(3))
            coverage: FloatArray = red + green + blue
        else:
            coverage = layer[..., 3]
        return coverage.clip(0.0, 1.0)[..., None]

    def _draw_image(self, picture: Picture, matrix: Matrix, window: Window) -> FloatArray:
        left, low, right, high = window
        moved = compose(translation(-left, -low), matrix)
        return draw_image_pixels(picture, moved, right - left, high - low, self._threads)

    def _draw_pattern(self, pattern: Pattern, matrix: Matrix, window: Window) -> FloatArray:
        """Fills a window with a pattern; the matrix leads from the outline's units to pixels."""
        whole = compose(matrix, pattern.matrix)
        left, top, right, bottom = pattern.tile
        width, height = right - left, bottom - top
        box = transform_box((*map(float, window),), inverse(whole))  # type: ignore[arg-type]
        columns = range(math.floor((box[0] - left) / width), math.ceil((box[2] - left) / width))
        rows = range(math.floor((box[1] - top) / height), math.ceil((box[3] - top) / height))
        tiles = (columns.stop - columns.start) * (rows.stop - rows.start)
        most = min(_MAX_TILES, _MAX_TILED // max(leaf_count(pattern.group), 1))
        if not all(is_plain(each.item) for each in self._layers.placed(pattern.group, whole)):
            most = min(most, _MAX_LAYERED_TILES)
        if tiles > most:
            return self._draw_tiled(pattern, whole, window)
        return self._draw_nested(
            chain.from_iterable(
                self._layers.placed(
                    pattern.group,
                    compose(whole, translation(column * width, row * height)),
                )
                for row in rows
                for column in columns
            ),
            window,
        )

    def _draw_tiled(self, pattern: Pattern, whole: Matrix, window: Window) -> FloatArray:
        """Fills a window with an image of one tile."""
        left, top, right, bottom = pattern.tile
        sides = (
            _native.hypot(*whole[:2]) * (right - left),
            _native.hypot(*whole[2:4]) * (bottom - top),
        )
        columns, rows = (min(max(math.ceil(side), _SMALLEST_TILE), _LARGEST_TILE) for side in sides)
        scale = (columns / (right - left), 0.0, 0.0, rows / (bottom - top), 0.0, 0.0)
        to_tile = compose(scale, translation(-left, -top))
        tile = self._draw_nested(self._layers.placed(pattern.group, to_tile), (0, 0, columns, rows))
        moved = compose(to_tile, inverse(whole))
        moved = compose(moved, translation(window[0], window[1]))
        size = window[2] - window[0], window[3] - window[1]
        if max(sides) < _MIN_RESOLVED_TILE:
            mean = tile.sum(axis=0, dtype=np.float64).sum(axis=0) / (columns * rows)
            return np.broadcast_to(mean.astype(np.float32), (size[1], size[0], 4)).copy()
        return fill_with_tile(tile, moved, *size, self._threads)


def touched_window(boxes: Sequence[Box], window: Window, reach: float) -> Window | None:
    """Returns the pixels of a window within `reach` of boxes; None if there are none."""
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


def _blend_part(
    canvas: FloatArray, window: Window, layer: FloatArray, part: Window, mode: str
) -> None:
    """Blends a layer into a part of a canvas."""
    rows = slice(part[1] - window[1], part[3] - window[1])
    columns = slice(part[0] - window[0], part[2] - window[0])
    canvas[rows, columns] = blend(canvas[rows, columns], layer, mode)
