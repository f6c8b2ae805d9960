# SPDX-License-Identifier: GPL-3.0-or-later

"""Clips made of outlines, and boxes cut off at clips."""

from collections.abc import Sequence

from ...affine import Matrix
from .outline import Outline
from .tree import Box, Clip, ClipPart, intersect_boxes, transform_box, unite_boxes


def make_clip(parts: Sequence[ClipPart], clips: tuple[Clip, ...]) -> Clip:
    """Makes the union of outlines, intersected with clips."""
    bounds: Box | None = None
    for part in parts:
        own = part.outline.bounds()
        box = transform_box(own, part.matrix) if own is not None else None
        bounds = unite_boxes(bounds, clip_box(box, part.clips))
    is_box = False
    if len(parts) == 1 and not parts[0].clips:
        a, b, c, d = parts[0].matrix[:4]
        is_upright = b == c == 0.0 or a == d == 0.0
        is_box = is_upright and parts[0].outline.is_box()
    return Clip(tuple(parts), clips, clip_box(bounds, clips), is_box and not clips)


def make_box_clip(box: Box, matrix: Matrix) -> Clip:
    """Makes a clip of a box; `matrix` leads from its units to the tree's."""
    left, top, right, bottom = box
    outline = Outline()
    outline.rectangle(left, top, right - left, bottom - top, 0.0, 0.0)
    return make_clip([ClipPart(outline, "nonzero", matrix)], ())


def clip_box(box: Box | None, clips: Sequence[Clip]) -> Box | None:
    """Returns the bounding box of a clipped box; None if it is empty."""
    for clip in clips:
        box = (
            intersect_boxes(box, clip.bounds)
            if box is not None and clip.bounds is not None
            else None
        )
    return box
