# SPDX-License-Identifier: GPL-3.0-or-later

"""The tree that is drawn: outlines and images, in groups."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ...affine import Matrix
from .gradients import Gradient
from .outline import Outline

Box: TypeAlias = tuple[float, float, float, float]
"""Left, top, right, bottom; top is the smaller y."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """Stroke properties of an outline, in its own units; see `Shape.stroked`.

    Attributes:
        dash_count: Upper bound of the number of dashes.
    """

    width: float
    cap: str
    join: str
    miter_limit: float
    dashes: tuple[float, ...]
    dash_offset: float
    dash_count: float = 0.0


@dataclass(frozen=True, slots=True)
class ClipPart:
    """One outline of a clip path.

    Attributes:
        matrix: From the outline's units to the tree's.
        clips: Clips of this part alone.
    """

    outline: Outline
    fill_rule: str
    matrix: Matrix
    clips: tuple["Clip", ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """A clip: the union of its parts, intersected with its own clips.

    Attributes:
        clips: Clips of the whole.
        bounds: Bounding box; None if the clip is empty.
        is_box: Whether the clip is exactly its bounding box.
    """

    parts: tuple[ClipPart, ...]
    clips: tuple["Clip", ...]
    bounds: Box | None
    is_box: bool


@dataclass(frozen=True, slots=True)
class Pattern:
    """A group that repeats in tiles.

    Attributes:
        group: The contents, in the pattern's units.
        matrix: From the pattern's units to the outline's.
    """

    group: "Group"
    tile: Box
    matrix: Matrix
    opacity: float


@dataclass(frozen=True, slots=True)
class Painted:
    """An outline that is filled or stroked; `clips` and `box` are in the tree's units.

    Attributes:
        outline: The outline, in its own units.
        matrix: From the outline's units to the tree's.
        paint: A color premultiplied by alpha; or a gradient or pattern, in the outline's units.
        stroke: The stroke; None to fill.
        is_crisp: Whether pixels are covered completely or not at all.
    """

    outline: Outline
    fill_rule: str
    matrix: Matrix
    paint: tuple[float, ...] | Gradient | Pattern
    stroke: Stroke | None
    clips: tuple[Clip, ...]
    box: Box
    line: int
    is_crisp: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A raster image; `clips` and `box` are in the tree's units.

    Attributes:
        texels: (height, width, 4) bytes: encoded red, green and blue with straight alpha; top row
            first.
        matrix: From the unit square, y downwards, to the tree's units.
        is_pixelated: Whether enlarged texels keep sharp edges.
        is_linear: Whether colors are decoded before filtering.
    """

    texels: npt.NDArray[np.uint8]
    matrix: Matrix
    is_pixelated: bool
    is_linear: bool
    clips: tuple[Clip, ...]
    box: Box
    line: int


@dataclass(frozen=True, slots=True)
class Mask:
    """A mask of a group.

    Attributes:
        group: The contents, used by luminance or by alpha.
        is_linear: Whether luminance is computed from decoded colors.
    """

    group: "Group"
    is_luminance: bool
    is_linear: bool


@dataclass(frozen=True, slots=True)
class Step:
    """A filter primitive, such as `feOffset`.

    Attributes:
        kind: The element's name.
        inputs: Names of results; empty for the previous one.
        result: Name of the result.
        numbers: Parameters; lengths are in the filter's units.
        is_linear: Whether it works on decoded colors.
        region: The primitive's subregion, in the filter's units; None for that of its inputs.
    """

    kind: str
    inputs: tuple[str, ...]
    result: str
    numbers: tuple[float, ...]
    name: str
    is_linear: bool
    region: Box | None
    group: "Group | None" = None


@dataclass(frozen=True, slots=True)
class Filter:
    """A filter effect.

    Attributes:
        region: The filter region, in the filter's units; None if unbounded.
        matrix: From the filter's units, which are those of its element, to the tree's.
        is_linear: Whether the group's colors are decoded.
    """

    steps: tuple[Step, ...]
    region: Box | None
    matrix: Matrix
    is_linear: bool


@dataclass(slots=True, eq=False)
class Group:
    """Items composited as one.

    Attributes:
        items: Bottom item first.
        masks: Applied after the filter.
        filter: Applied to the group's pixels.
        clips: Clips of the filter's result; only with a filter, whose input is not clipped.
        is_isolated: Whether items blend only with each other.
    """

    items: list["Item"] = field(default_factory=list)
    opacity: float = 1.0
    blend: str = "normal"
    masks: tuple[Mask, ...] = ()
    filter: Filter | None = None
    clips: tuple[Clip, ...] = ()
    is_isolated: bool = False
    line: int = 0


Item: TypeAlias = Painted | Picture | Group


def leaves(group: Group) -> Iterator[Painted | Picture]:
    """Yields the outlines and images of a group, bottom first."""
    waiting: list[Item] = [group]
    while waiting:
        item = waiting.pop()
        if isinstance(item, Group):
            waiting.extend(reversed(item.items))
        else:
            yield item


def transform_box(box: Box, matrix: Matrix) -> Box:
    """Returns the bounding box of a transformed box."""
    a, b, c, d, e, f = matrix
    points = [(a * x + c * y + e, b * x + d * y + f) for x in box[::2] for y in box[1::2]]
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def intersect_boxes(one: Box, other: Box) -> Box | None:
    """Returns the intersection of two boxes; None if it has no area."""
    left, top = max(one[0], other[0]), max(one[1], other[1])
    right, bottom = min(one[2], other[2]), min(one[3], other[3])
    return (left, top, right, bottom) if left < right and top < bottom else None


def unite_boxes(one: Box | None, other: Box | None) -> Box | None:
    """Returns the bounding box of both."""
    if one is None or other is None:
        return one or other
    low, high = map(min, one[:2], other[:2]), map(max, one[2:], other[2:])
    return (*low, *high)  # type: ignore[return-value]


def contains_box(outer: Box, inner: Box) -> bool:
    """Returns whether a box contains another one, up to rounding."""
    # Relative to the inner box: the outer one may be much larger, and end close to the inner one.
    wide, high = 1e-6 * (inner[2] - inner[0]), 1e-6 * (inner[3] - inner[1])
    return (
        inner[0] >= outer[0] - wide
        and inner[1] >= outer[1] - high
        and inner[2] <= outer[2] + wide
        and inner[3] <= outer[3] + high
    )


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
        box = intersect_boxes(box, clip.bounds) if box and clip.bounds else None
    return box
