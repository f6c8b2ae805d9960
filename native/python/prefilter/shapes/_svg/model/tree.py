# SPDX-License-Identifier: GPL-3.0-or-later

"""What a drawing consists of, as a tree: outlines and pictures in groups that are seen as one."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ...affine import Matrix
from .gradients import Gradient
from .outline import Outline

Box: TypeAlias = tuple[float, float, float, float]
"""Left, top, right, bottom."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """How an outline is stroked, in its own units, as `Shape.stroked` takes it.

    Attributes:
        dash_count: How many dashes there are at most.
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
    """An outline that lets through what it fills.

    Attributes:
        matrix: From its units to those of the tree.
        clips: What it is cut off at itself.
    """

    outline: Outline
    fill_rule: str
    matrix: Matrix
    clips: tuple["Clip", ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """What things are cut off at: all that its parts let through.

    Attributes:
        clips: What the whole of it is cut off at itself.
        bounds: The box around it; None where nothing is let through.
        is_box: Whether it is that box.
    """

    parts: tuple[ClipPart, ...]
    clips: tuple["Clip", ...]
    bounds: Box | None
    is_box: bool


@dataclass(frozen=True, slots=True)
class Pattern:
    """A group that is repeated.

    Attributes:
        group: In the units of the pattern.
        tile: The box that is repeated.
        matrix: From the pattern's units to those of the outline.
        opacity: Of the paint.
    """

    group: "Group"
    tile: Box
    matrix: Matrix
    opacity: float


@dataclass(frozen=True, slots=True)
class Painted:
    """An outline to fill or to stroke.

    Attributes:
        outline: In its own units.
        fill_rule: For what it fills.
        matrix: From its units to those of the tree.
        paint: A color, multiplied by its alpha; or a gradient or pattern in the outline's units.
        stroke: None where it is filled.
        clips: What it is cut off at.
        box: Around it, in the tree's units.
        line: Where it is in the file.
        is_crisp: Whether each pixel is covered wholly or not at all.
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
    """An image.

    Attributes:
        texels: (height, width, 4) bytes: red, green, blue and alpha, not multiplied by it, as they
            are encoded; the top row first.
        matrix: From the unit square, with y downwards, to the tree's units.
        is_pixelated: Whether its texels are to be seen.
        is_linear: Whether colors are to be decoded.
        clips: What it is cut off at.
        box: Around it, in the tree's units.
        line: Where it is in the file.
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
    """What lets a group through in parts.

    Attributes:
        group: By its luminance, or by its alpha.
        is_linear: Whether luminance is that of decoded colors.
    """

    group: "Group"
    is_luminance: bool
    is_linear: bool


@dataclass(frozen=True, slots=True)
class Step:
    """A step of a filter: an element such as `feOffset`.

    Attributes:
        kind: The element's name.
        inputs: The names of other results; empty for the one before.
        result: What its own is called.
        numbers: What it needs; lengths are those of the filter.
        name: Of its operator or mode.
        is_linear: Whether it takes decoded colors.
        region: Where it ends, in the filter's units; None for where its inputs do.
        group: What `feImage` shows.
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
    """What becomes of a group's pixels.

    Attributes:
        region: Where it is applied, in its units; None where it ends nowhere.
        matrix: From its units, those of its element, to the tree's.
        is_linear: Whether the group's colors are decoded.
    """

    steps: tuple[Step, ...]
    region: Box | None
    matrix: Matrix
    is_linear: bool


@dataclass(slots=True, eq=False)
class Group:
    """What belongs together.

    Attributes:
        items: First what is below.
        opacity: Of the whole.
        blend: How it is mixed with what is below it, by the name of `mix-blend-mode`.
        masks: What lets it through.
        filter: What becomes of its pixels before that.
        clips: With a filter: what it is cut off at, which things in it are not.
        is_isolated: Whether what is in it is mixed with nothing below it.
        line: Where it is in the file.
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
    """Yields the outlines and pictures of a group, first what is below."""
    waiting: list[Item] = [group]
    while waiting:
        item = waiting.pop()
        if isinstance(item, Group):
            waiting.extend(reversed(item.items))
        else:
            yield item


def carried(box: Box, matrix: Matrix) -> Box:
    """The box around a box that went through a matrix."""
    a, b, c, d, e, f = matrix
    points = [(a * x + c * y + e, b * x + d * y + f) for x in box[::2] for y in box[1::2]]
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def common(one: Box, other: Box) -> Box | None:
    """What two boxes have in common; None where that has no area."""
    left, top = max(one[0], other[0]), max(one[1], other[1])
    right, bottom = min(one[2], other[2]), min(one[3], other[3])
    return (left, top, right, bottom) if left < right and top < bottom else None


def joined(one: Box | None, other: Box | None) -> Box | None:
    """The box around both."""
    if one is None or other is None:
        return one or other
    low, high = map(min, one[:2], other[:2]), map(max, one[2:], other[2:])
    return (*low, *high)  # type: ignore[return-value]


def holds(outer: Box, inner: Box) -> bool:
    """Whether a box holds another one, but for rounding."""
    # By the inner one: a large outer one may be cut off close to what is looked at.
    wide, high = 1e-6 * (inner[2] - inner[0]), 1e-6 * (inner[3] - inner[1])
    return (
        inner[0] >= outer[0] - wide
        and inner[1] >= outer[1] - high
        and inner[2] <= outer[2] + wide
        and inner[3] <= outer[3] + high
    )
