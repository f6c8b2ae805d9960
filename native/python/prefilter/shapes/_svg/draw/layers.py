# SPDX-License-Identifier: GPL-3.0-or-later

"""Decides which groups need a layer, and which look the same drawn item by item."""

from collections.abc import Iterator
from dataclasses import dataclass

from ...affine import IDENTITY, Matrix
from ..filters.evaluation import filter_reach
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
    """An item to draw by itself.

    Attributes:
        matrix: From the tree's units to pixels.
        opacity: Product of its groups' opacities.
        group_clips: Clips of its groups, in addition to its own.
    """

    item: Item
    matrix: Matrix
    opacity: float
    group_clips: tuple[Clip, ...]


class LayerPlanner:
    """Splits trees into items; caches the decision for each group."""

    def __init__(self) -> None:
        self._known: dict[Group, bool] = {}

    def placed(
        self, group: Group, matrix: Matrix, group_clips: tuple[Clip, ...] = (), opacity: float = 1.0
    ) -> Iterator[PlacedItem]:
        """Yields outlines, images and groups with layers, bottom first."""
        for item in group.items:
            if isinstance(item, Group) and not self.needs_layer(item):
                yield from self.placed(item, matrix, group_clips, opacity * item.opacity)
            else:
                yield PlacedItem(item, matrix, opacity, group_clips)

    def needs_layer(self, group: Group) -> bool:
        """Returns whether a group would look different drawn item by item."""
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
        """Returns whether items of a group blend with their backdrop."""
        inner = [item for item in group.items if isinstance(item, Group)]
        return any(
            item.blend != "normal" or (not self.needs_layer(item) and self._is_mixing(item))
            for item in inner
        )

    def _is_overlapping(self, group: Group) -> bool:
        items = [placed.item for placed in self.placed(group, _ANY_MATRIX)]
        if any(isinstance(item, Group) for item in items) or len(items) > _MAX_COMPARED:
            return True
        boxes = [item.box for item in items if not isinstance(item, Group)]
        return any(
            intersect_boxes(box, other) is not None
            for k, box in enumerate(boxes)
            for other in boxes[:k]
        )


_ANY_MATRIX: Matrix = IDENTITY


def is_plain(item: Item) -> bool:
    """Returns whether an item is an outline with a color or gradient."""
    return isinstance(item, Painted) and not isinstance(item.paint, Pattern)


def item_bounds(item: Item) -> Iterator[Box]:
    """Yields boxes that contain an item's visible parts, in the tree's units."""
    box: Box | None
    if not isinstance(item, Group):
        box = item.box
    elif item.filter is not None:
        box = filtered_region(item)
    else:
        for inner in item.items:
            yield from item_bounds(inner)
        return
    for clip in item.clips:
        box = intersect_boxes(box, clip.bounds) if box and clip.bounds else None
    if box is not None:
        yield box


def filtered_region(group: Group) -> Box | None:
    """Returns the box of a filter's result, in the tree's units; None if it is empty."""
    filter_ = group.filter
    assert filter_ is not None
    if filter_.region is not None:
        return transform_box(filter_.region, filter_.matrix)
    box: Box | None = None
    for item in group.items:
        for inner in item_bounds(item):
            box = unite_boxes(box, inner)
    if box is None:
        return None
    more = filter_reach(filter_, IDENTITY)
    return box[0] - more, box[1] - more, box[2] + more, box[3] + more


def leaf_count(group: Group) -> int:
    """Counts outlines and images."""
    return sum(1 for _ in leaves(group))
