# SPDX-License-Identifier: GPL-3.0-or-later

"""Groups that are seen as one: whether drawing their shapes one by one shows the same."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypeAlias

from .document import SvgElement
from .values import Matrix
from .warnings import Warnings

Box: TypeAlias = tuple[float, float, float, float]
"""Left, top, right, bottom."""

_MOST_COMPARED = 200
# Of the larger side: what rounding makes of a box that fits.
_SLACK = 1e-6


@dataclass(frozen=True)
class _Group:
    """Shapes that belong together.

    Attributes:
        element: Where that is said.
        name: Of the property that says it.
        region: What they are cut off at; a box in the drawing's units, or None for something else.
        boxes: Of the shapes, in the drawing's units.
    """

    element: SvgElement
    name: str
    region: Box | None
    boxes: list[Box] = field(default_factory=list)


class Groups:
    """The groups of a drawing that are translucent, or cut off.

    Args:
        view: What the drawing shows, in its units.
        warnings: Gets those that look different shape by shape.
    """

    def __init__(self, view: Box, warnings: Warnings) -> None:
        self._view = view
        self._warnings = warnings
        self._translucent: list[_Group] = []
        self._clipped: list[_Group] = []
        self._all: list[_Group] = []

    def add_translucent(self, element: SvgElement) -> int:
        """Begins a group with an opacity; returns its number."""
        self._translucent.append(_Group(element, "opacity", None))
        return self._add(self._translucent[-1])

    def add_clipped(self, element: SvgElement, name: str, region: Box | None) -> int:
        """Begins a group that a property of that name cuts off; returns its number."""
        self._clipped.append(_Group(element, name, region))
        return self._add(self._clipped[-1])

    def _add(self, group: _Group) -> int:
        self._all.append(group)
        return len(self._all) - 1

    def put(self, numbers: Iterable[int], box: Box) -> None:
        """Puts a shape in groups, by their numbers."""
        for number in numbers:
            self._all[number].boxes.append(box)

    def check(self) -> None:
        """Tells of the groups whose look is not that of their shapes, one by one."""
        for group in self._translucent:
            boxes = group.boxes
            if len(boxes) > _MOST_COMPARED or any(
                _meet(box, other) for k, box in enumerate(boxes) for other in boxes[:k]
            ):
                self._warnings.unsupported(
                    "opacity of a group", "applied to each of its shapes", group.element.line
                )
        for group in self._clipped:
            if not all(self._is_within(box, group.region) for box in group.boxes):
                self._warnings.unsupported(group.name, "not cut off", group.element.line)

    def _is_within(self, box: Box, region: Box | None) -> bool:
        """Whether what shows of a box is in the region."""
        if region is None:
            return False
        view = self._view
        left, top = max(box[0], view[0]), max(box[1], view[1])
        right, bottom = min(box[2], view[2]), min(box[3], view[3])
        if left >= right or top >= bottom:
            return True
        slack = _SLACK * max(view[2] - view[0], view[3] - view[1])
        return (
            left >= region[0] - slack
            and top >= region[1] - slack
            and right <= region[2] + slack
            and bottom <= region[3] + slack
        )


def carried(box: Box, matrix: Matrix) -> Box:
    """The box around a box that went through a matrix."""
    a, b, c, d, e, f = matrix
    points = [(a * x + c * y + e, b * x + d * y + f) for x in box[::2] for y in box[1::2]]
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def _meet(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
