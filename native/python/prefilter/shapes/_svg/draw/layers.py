# SPDX-License-Identifier: GPL-3.0-or-later

"""Which groups of a tree need a layer of their own, and which show the same item by item."""

from collections.abc import Iterator
from dataclasses import dataclass

from ...affine import IDENTITY, Matrix
from ..filters.evaluation import reach_of
from ..model.tree import (
    Box,
    Clip,
    Group,
    Item,
    Painted,
    Pattern,
    intersect_boxes,
    leaves,
    transform_box,
    unite_boxes,
)

_MAX_COMPARED = 200


@dataclass(frozen=True, slots=True)
class PlacedItem:
    """What is drawn by itself.

    Attributes:
        matrix: From its tree's units to pixels.
        opacity: Of the groups around it.
        around: What it is cut off at beside its own clips.
    """

    item: Item
    matrix: Matrix
    opacity: float
    around: tuple[Clip, ...]


class LayerPlanner:
    """Takes trees apart; knows the groups that it has seen."""

    def __init__(self) -> None:
        self._known: dict[Group, bool] = {}

    def placed(
        self, group: Group, matrix: Matrix, around: tuple[Clip, ...] = (), opacity: float = 1.0
    ) -> Iterator[PlacedItem]:
        """Yields outlines, pictures and groups with layers, first what is below."""
        for item in group.items:
            if isinstance(item, Group) and not self.needs_layer(item):
                yield from self.placed(item, matrix, around, opacity * item.opacity)
            else:
                yield PlacedItem(item, matrix, opacity, around)

    def needs_layer(self, group: Group) -> bool:
        """Whether a group looks different from its items, drawn one by one."""
        if group not in self._known:
            self._known[group] = (
                bool(group.masks)
                or group.filter is not None
                or group.blend != "normal"
                or (group.opacity < 1.0 and self._is_overlapping(group))
                or (group.is_isolated and self._is_mixing(group))
            )
        return self._known[group]

    def _is_mixing(self, group: Group) -> bool:
        """Whether something in a group is mixed with what is below it."""
        inner = [item for item in group.items if isinstance(item, Group)]
        return any(
            item.blend != "normal" or (not self.needs_layer(item) and self._is_mixing(item))
            for item in inner
        )

    def _is_overlapping(self, group: Group) -> bool:
        items = [placed.item for placed in self.placed(group, _UNUSED)]
        if any(isinstance(item, Group) for item in items) or len(items) > _MAX_COMPARED:
            return True
        boxes = [item.box for item in items if not isinstance(item, Group)]
        return any(
            intersect_boxes(box, other) is not None
            for k, box in enumerate(boxes)
            for other in boxes[:k]
        )


_UNUSED: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)


def is_plain(item: Item) -> bool:
    """Whether an item is an outline of a color or gradient."""
    return isinstance(item, Painted) and not isinstance(item.paint, Pattern)


def bounds_of(item: Item) -> Iterator[Box]:
    """Yields boxes, in the tree's units, that hold what shows of an item."""
    box: Box | None
    if not isinstance(item, Group):
        box = item.box
    elif item.filter is not None:
        box = filtered_region(item)
    else:
        for inner in item.items:
            yield from bounds_of(inner)
        return
    for clip in item.clips:
        box = intersect_boxes(box, clip.bounds) if box and clip.bounds else None
    if box is not None:
        yield box


def filtered_region(group: Group) -> Box | None:
    """Where the result of a group's filter ends, in the tree's units; None where it is nothing."""
    filter_ = group.filter
    assert filter_ is not None
    if filter_.region is not None:
        return transform_box(filter_.region, filter_.matrix)
    box: Box | None = None
    for item in group.items:
        for inner in bounds_of(item):
            box = unite_boxes(box, inner)
    if box is None:
        return None
    more = reach_of(filter_, IDENTITY)
    return box[0] - more, box[1] - more, box[2] + more, box[3] + more


def leaf_count(group: Group) -> int:
    """How many outlines and pictures there are."""
    return sum(1 for _ in leaves(group))
