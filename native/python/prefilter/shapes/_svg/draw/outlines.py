# SPDX-License-Identifier: GPL-3.0-or-later

"""Outlines of a tree as shapes in pixels, clipped exactly."""

from collections.abc import Sequence
from dataclasses import asdict

from .... import _native
from ...affine import Matrix, as_rows, compose, determinant
from ...shape import Shape
from ..filters.evaluation import is_upright
from ..model.gradients import Gradient
from ..model.limits import TooLargeError
from ..model.tree import Box, Clip, Group, Painted, Picture, contains_box, intersect_boxes

# Pixels. Coordinates beyond are clamped, so that one distant point costs no precision nearby.
_MAX_COORDINATE = float(1 << 21)
# Largest error of a stroke's outline, in pixels: invisible in 8-bit images.
_STROKE_TOLERANCE = 1.0 / 1024.0


class ShapeBuilder:
    """Makes shapes; caches the regions of clips."""

    def __init__(self) -> None:
        self._regions: dict[tuple[Clip, Matrix], Shape] = {}

    def shape(
        self, painted: Painted, matrix: Matrix, opacity: float, group_clips: Sequence[Clip] = ()
    ) -> Shape | None:
        """Makes a shape with its paint, or white for a pattern; returns None if it is invisible.

        Args:
            matrix: From the tree's units to pixels, y upwards.
            group_clips: Clips in addition to the outline's own.
        """
        box, clips = painted.box, (*group_clips, *painted.clips)
        if any(clip.bounds is None or intersect_boxes(box, clip.bounds) is None for clip in clips):
            return None
        whole = compose(matrix, painted.matrix)
        if determinant(whole) == 0.0:
            return None
        shape = painted.outline.shape(painted.fill_rule)
        if painted.stroke is not None:
            scale = max(_native.hypot(*whole[:2]), _native.hypot(*whole[2:4]))
            pen = asdict(painted.stroke)
            del pen["dash_count"]
            shape = shape.stroked(**pen, tolerance=_STROKE_TOLERANCE / scale)
        shape = _clamp(shape.transformed(as_rows(whole)))
        if painted.is_crisp:
            shape = _snap_to_pixels(shape)
        if isinstance(painted.paint, Gradient):
            painted.paint.apply(shape, whole, opacity)
        elif isinstance(painted.paint, tuple):
            shape.color = tuple(opacity * value for value in painted.paint)
        return self.clip(shape, box, clips, matrix)

    def image_area(
        self, picture: Picture, matrix: Matrix, group_clips: Sequence[Clip]
    ) -> Shape | None:
        """Makes a shape of an image's visible area; returns None if it is empty."""
        clips = (*group_clips, *picture.clips)
        whole = compose(matrix, picture.matrix)
        hidden = any(
            clip.bounds is None or not intersect_boxes(picture.box, clip.bounds) for clip in clips
        )
        if hidden or determinant(whole) == 0.0:
            return None
        shape = Shape()
        shape.add_polygon([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
        return self.clip(shape.transformed(as_rows(whole)), picture.box, clips, matrix)

    def filter_clip(self, group: Group, clips: Sequence[Clip], matrix: Matrix) -> list[Shape]:
        """Returns the shape that clips a filter's result, or no shape if it is not clipped.

        Filter regions end at whole pixels if upright, and need no clip.
        """
        filter_ = group.filter
        assert filter_ is not None
        if any(clip.bounds is None for clip in clips):
            return [Shape()]
        to_pixels = compose(matrix, filter_.matrix)
        shapes = [self._region(clip, matrix) for clip in clips]
        if filter_.region is not None and not is_upright(to_pixels):
            left, top, right, bottom = filter_.region
            shape = Shape()
            shape.add_polygon([(left, top), (right, top), (right, bottom), (left, bottom)])
            shapes.append(shape.transformed(as_rows(to_pixels)))
        while len(shapes) > 1:
            shapes[-2:] = [_combine(shapes[-2], shapes[-1], "intersection")]
        return shapes

    def clip(self, shape: Shape, box: Box, clips: Sequence[Clip], matrix: Matrix) -> Shape:
        """Clips a shape that lies within a box of the tree."""
        for clip in clips:
            if clip.is_box and clip.bounds is not None and contains_box(clip.bounds, box):
                continue
            shape = _combine(shape, self._region(clip, matrix), "intersection")
        return shape

    def _region(self, clip: Clip, matrix: Matrix) -> Shape:
        """Returns the region of a clip."""
        key = (clip, matrix)
        if key not in self._regions:
            region: Shape | None = None
            for part in clip.parts:
                whole = compose(matrix, part.matrix)
                if determinant(whole) == 0.0:
                    continue
                shape = _clamp(part.outline.shape(part.fill_rule).transformed(as_rows(whole)))
                for inner in part.clips:
                    shape = _combine(shape, self._region(inner, matrix), "intersection")
                region = shape if region is None else _combine(region, shape, "union")
            region = Shape() if region is None else region
            for outer in clip.clips:
                region = _combine(region, self._region(outer, matrix), "intersection")
            self._regions[key] = region
        return self._regions[key]


def _combine(first: Shape, second: Shape, operation: str) -> Shape:
    """Combines the fills of two shapes; the first one's paint remains."""
    rules = first.fill_rule, second.fill_rule
    try:
        outline = first._outline.combined(rules[0], second._outline, rules[1], operation)
    except ValueError:
        raise TooLargeError("clip paths cannot cut what is more than 1e100 pixels away") from None
    combined = first._with(outline, first._paint)
    combined._fill_rule, combined._winds_once = "nonzero", True
    return combined


def _clamp(shape: Shape) -> Shape:
    """Clamps a shape to coordinates below the limit."""
    bounds = shape.bounds
    if bounds is None or max(abs(value) for point in bounds for value in point) <= _MAX_COORDINATE:
        return shape
    return shape._with(shape._outline.within(_MAX_COORDINATE), shape._paint)


def _snap_to_pixels(shape: Shape) -> Shape:
    """Returns the pixels whose centers are inside a shape."""
    snapped = shape._with(shape._outline.pixels(shape.fill_rule), shape._paint)
    snapped._fill_rule, snapped._winds_once = "nonzero", True
    return snapped
