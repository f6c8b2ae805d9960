# SPDX-License-Identifier: GPL-3.0-or-later

"""Layers of filtered groups, evaluated without rotation and then warped into place."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from .... import _native
from ...affine import Matrix, compose, inverse, translation
from ..model.tree import Box, Filter, Group, intersect_boxes, transform_box
from .evaluation import apply_filter, filter_reach, is_upright
from .warping import warp_image

FloatArray = npt.NDArray[np.float32]
Window = tuple[int, int, int, int]
"""Pixels: left, low, right, high; right and high are exclusive."""
Draw = Callable[[Group, Matrix, Window], FloatArray]
"""Returns the pixels of a group's contents; the matrix leads from the tree to pixels."""

# Pixels around a region that warping reads.
_MARGIN = 3


def filtered_layer(
    draw: Draw, group: Group, box: Box, matrix: Matrix, window: Window, threads: int
) -> FloatArray:
    """Draws a group and applies its filter.

    Args:
        box: Bounds of the result, in the tree's units.
        matrix: From the tree's units to pixels.
    """
    filter_ = _filter_of(group)
    to_pixels = compose(matrix, filter_.matrix)
    # Pixels beyond half a side are ignored, to limit memory.
    limit = max(window[2] - window[0], window[3] - window[1]) / 2.0
    reach = math.ceil(min(filter_reach(filter_, matrix), limit))
    left, low, right, high = window
    reachable = (float(left - reach), float(low - reach), float(right + reach), float(high + reach))
    if is_upright(to_pixels):
        return _draw_upright(
            draw, group, transform_box(box, matrix), reachable, (matrix, to_pixels), window
        )
    return _draw_warped(draw, group, box, reachable, (matrix, to_pixels), window, threads)


def _draw_upright(
    draw: Draw,
    group: Group,
    box: Box,
    reachable: Box,
    matrices: tuple[Matrix, Matrix],
    window: Window,
) -> FloatArray:
    layer = np.zeros((window[3] - window[1], window[2] - window[0], 4), np.float32)
    region = _pixels(intersect_boxes(box, reachable))
    shared = intersect_boxes((*map(float, window),), (*map(float, region),)) if region else None  # type: ignore[arg-type]
    if region is None or shared is None:
        return layer
    pixels = _filter_region(draw, group, matrices, region)
    left, low, right, high = map(int, shared)
    rows, columns = (
        slice(low - window[1], high - window[1]),
        slice(left - window[0], right - window[0]),
    )
    layer[rows, columns] = pixels[
        low - region[1] : high - region[1], left - region[0] : right - region[0]
    ]
    return layer


def _draw_warped(
    draw: Draw,
    group: Group,
    box: Box,
    reachable: Box,
    matrices: tuple[Matrix, Matrix],
    window: Window,
    threads: int,
) -> FloatArray:
    """Draws and filters the group upright, and warps the result."""
    to_pixels = matrices[1]
    filter_ = _filter_of(group)
    width, height = window[2] - window[0], window[3] - window[1]
    across, along = _native.hypot(*to_pixels[:2]), _native.hypot(*to_pixels[2:4])
    limit = 2.0 * max(reachable[2] - reachable[0], reachable[3] - reachable[1])

    def place_upright() -> tuple[Matrix, Window | None]:
        upright: Matrix = (across, 0.0, 0.0, -along, 0.0, 0.0)
        whole = transform_box(box, compose(upright, inverse(filter_.matrix)))
        visible = transform_box(reachable, compose(upright, inverse(to_pixels)))
        return upright, _pixels(intersect_boxes(whole, visible))

    upright, region = place_upright()
    largest = max(region[2] - region[0], region[3] - region[1]) if region else 0
    if largest > limit:
        # Limits the resolution under strong shear.
        across, along = (side * limit / largest for side in (across, along))
        upright, region = place_upright()
    if region is None:
        return np.zeros((height, width, 4), np.float32)
    to_upright = compose(upright, inverse(filter_.matrix))
    pixels = _filter_region(draw, _extend(group, across, along), (to_upright, upright), region)
    back = compose(translation(-region[0], -region[1]), compose(upright, inverse(to_pixels)))
    back = compose(back, translation(window[0], window[1]))
    return warp_image(pixels, back, width, height, threads)


def _filter_region(
    draw: Draw, group: Group, matrices: tuple[Matrix, Matrix], region: Window
) -> FloatArray:
    return apply_filter(
        lambda shown: draw(shown, matrices[0], region),
        group,
        _filter_of(group),
        matrices[1],
        region,
    )


def _extend(group: Group, across: float, along: float) -> Group:
    """Extends a filter's region by a margin for warping, which is clipped later."""
    filter_ = _filter_of(group)
    if filter_.region is None:
        return group
    left, top, right, bottom = filter_.region
    x, y = _MARGIN / across, _MARGIN / along
    region = (left - x, top - y, right + x, bottom + y)
    return replace(group, filter=replace(filter_, region=region))


def _filter_of(group: Group) -> Filter:
    assert group.filter is not None
    return group.filter


def _pixels(box: Box | None) -> Window | None:
    """Returns the pixels that a box touches, with a margin."""
    if box is None:
        return None
    left, low = math.floor(box[0]) - _MARGIN, math.floor(box[1]) - _MARGIN
    return left, low, math.ceil(box[2]) + _MARGIN, math.ceil(box[3]) + _MARGIN
