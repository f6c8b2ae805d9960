# SPDX-License-Identifier: GPL-3.0-or-later

"""Outlines of a tree as shapes in pixels, cut off exactly at what they are clipped by."""

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from .... import _native
from ...affine import Matrix, determinant, multiplied
from ...shape import Shape
from ..filters.evaluation import is_upright
from ..model.gradients import Gradient
from ..model.limits import TooLargeError
from ..model.tree import Box, Clip, Group, Painted, Picture, contains_box, intersect_boxes

# Pixels farther away than this are not looked at: what an outline has there is drawn together, so
# that one far point takes nothing from what is near.
_FARTHEST = float(1 << 21)
# How far the outline of a stroke may be off, in pixels: 8-bit images do not show it.
_STROKE_TOLERANCE = 1.0 / 1024.0


class ShapeBuilder:
    """Makes shapes, and keeps what clips let through."""

    def __init__(self) -> None:
        self._regions: dict[tuple[Clip, Matrix], Shape] = {}

    def shape(
        self, painted: Painted, matrix: Matrix, opacity: float, around: Sequence[Clip] = ()
    ) -> Shape | None:
        """An outline with its paint; white for a pattern. None where nothing of it shows.

        Args:
            painted: The outline.
            matrix: From the tree's units to pixels, with y upwards.
            opacity: Multiplies the paint.
            around: What it is cut off at beside its own clips.
        """
        box, clips = painted.box, (*around, *painted.clips)
        if any(clip.bounds is None or intersect_boxes(box, clip.bounds) is None for clip in clips):
            return None
        whole = multiplied(matrix, painted.matrix)
        if determinant(whole) == 0.0:
            return None
        shape = painted.outline.shape(painted.fill_rule)
        if painted.stroke is not None:
            scale = max(_native.hypot(*whole[:2]), _native.hypot(*whole[2:4]))
            pen = asdict(painted.stroke)
            del pen["dash_count"]
            shape = shape.stroked(**pen, tolerance=_STROKE_TOLERANCE / scale)
        shape = _near(shape.transformed(_rows(whole)))
        if painted.is_crisp:
            shape = _crisp(shape)
        if isinstance(painted.paint, Gradient):
            painted.paint.apply(shape, whole, opacity)
        elif isinstance(painted.paint, tuple):
            shape.color = tuple(opacity * value for value in painted.paint)
        return self.clipped(shape, box, clips, matrix)

    def frame(self, picture: Picture, matrix: Matrix, around: Sequence[Clip]) -> Shape | None:
        """What shows of a picture, likewise; None for nothing."""
        clips = (*around, *picture.clips)
        whole = multiplied(matrix, picture.matrix)
        hidden = any(
            clip.bounds is None or not intersect_boxes(picture.box, clip.bounds) for clip in clips
        )
        if hidden or determinant(whole) == 0.0:
            return None
        shape = Shape()
        shape.add_polygon([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
        return self.clipped(shape.transformed(_rows(whole)), picture.box, clips, matrix)

    def filtered(self, group: Group, clips: Sequence[Clip], matrix: Matrix) -> list[Shape]:
        """What the result of a group's filter is cut off at: nothing, or a shape.

        Pixels at the edges of an upright region are whole, so that clips alone cut it off.
        """
        filter_ = group.filter
        assert filter_ is not None
        if any(clip.bounds is None for clip in clips):
            return [Shape()]
        to_pixels = multiplied(matrix, filter_.matrix)
        shapes = [self._region(clip, matrix) for clip in clips]
        if filter_.region is not None and not is_upright(to_pixels):
            left, top, right, bottom = filter_.region
            shape = Shape()
            shape.add_polygon([(left, top), (right, top), (right, bottom), (left, bottom)])
            shapes.append(shape.transformed(_rows(to_pixels)))
        while len(shapes) > 1:
            shapes[-2:] = [_combined(shapes[-2], shapes[-1], "intersection")]
        return shapes

    def clipped(self, shape: Shape, box: Box, clips: Sequence[Clip], matrix: Matrix) -> Shape:
        """What clips leave of a shape that lies within a box of the tree."""
        for clip in clips:
            if clip.is_box and clip.bounds is not None and contains_box(clip.bounds, box):
                continue
            shape = _combined(shape, self._region(clip, matrix), "intersection")
        return shape

    def _region(self, clip: Clip, matrix: Matrix) -> Shape:
        """What a clip lets through."""
        key = (clip, matrix)
        if key not in self._regions:
            region: Shape | None = None
            for part in clip.parts:
                whole = multiplied(matrix, part.matrix)
                if determinant(whole) == 0.0:
                    continue
                shape = _near(part.outline.shape(part.fill_rule).transformed(_rows(whole)))
                for inner in part.clips:
                    shape = _combined(shape, self._region(inner, matrix), "intersection")
                region = shape if region is None else _combined(region, shape, "union")
            region = Shape() if region is None else region
            for outer in clip.clips:
                region = _combined(region, self._region(outer, matrix), "intersection")
            self._regions[key] = region
        return self._regions[key]


def _combined(first: Shape, second: Shape, operation: str) -> Shape:
    """A set operation of what two shapes fill, with the paint of the first."""
    rules = first.fill_rule, second.fill_rule
    try:
        outline = first._outline.combined(rules[0], second._outline, rules[1], operation)
    except ValueError:
        raise TooLargeError("clip paths cannot cut what is more than 1e100 pixels away") from None
    made = first._with(outline, first._paint)
    made._fill_rule, made._winds_once = "nonzero", True
    return made


def _near(shape: Shape) -> Shape:
    """What a shape fills not too far away."""
    bounds = shape.bounds
    if bounds is None or max(abs(value) for point in bounds for value in point) <= _FARTHEST:
        return shape
    return shape._with(shape._outline.within(_FARTHEST), shape._paint)


def _crisp(shape: Shape) -> Shape:
    """The pixels whose centers a shape fills."""
    made = shape._with(shape._outline.pixels(shape.fill_rule), shape._paint)
    made._fill_rule, made._winds_once = "nonzero", True
    return made


def _rows(matrix: Matrix) -> np.ndarray:
    a, b, c, d, e, f = matrix
    return np.array([[a, c, e], [b, d, f]])
