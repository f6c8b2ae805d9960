# SPDX-License-Identifier: GPL-3.0-or-later

"""What things are cut off at, made of outlines."""

from collections.abc import Sequence

from ...affine import Matrix
from .outline import Outline
from .tree import Box, Clip, ClipPart, carried, common, joined


def clip_of(parts: Sequence[ClipPart], clips: tuple[Clip, ...]) -> Clip:
    """What all parts let through, cut off at others."""
    bounds: Box | None = None
    for part in parts:
        own = part.outline.bounds()
        box = carried(own, part.matrix) if own is not None else None
        bounds = joined(bounds, within(box, part.clips))
    is_box = False
    if len(parts) == 1 and not parts[0].clips:
        a, b, c, d = parts[0].matrix[:4]
        is_upright = b == c == 0.0 or a == d == 0.0
        is_box = is_upright and parts[0].outline.is_box()
    return Clip(tuple(parts), clips, within(bounds, clips), is_box and not clips)


def box_clip(box: Box, matrix: Matrix) -> Clip:
    """What a box lets through, in units that a matrix leads away from."""
    left, top, right, bottom = box
    outline = Outline()
    outline.rectangle(left, top, right - left, bottom - top, 0.0, 0.0)
    return clip_of([ClipPart(outline, "nonzero", matrix)], ())


def within(box: Box | None, clips: Sequence[Clip]) -> Box | None:
    """The box that holds what clips leave of one; None where that is nothing."""
    for clip in clips:
        box = common(box, clip.bounds) if box is not None and clip.bounds is not None else None
    return box
