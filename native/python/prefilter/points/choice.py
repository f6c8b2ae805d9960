# SPDX-License-Identifier: GPL-3.0-or-later

"""Selection of points by a box, by class and by return."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import as_one_of
from .._border.arrays import as_array, as_floats
from .scan import ScanPoints

Classes: TypeAlias = int | Sequence[int] | npt.NDArray[np.integer]

RETURNS = _native.RETURNS
_HIGHEST_CLASS = 255
_CLASS = "classification"
_NUMBER, _COUNT = "return_number", "number_of_returns"


@dataclass(frozen=True, eq=False)
class Choice:
    """Conditions that chosen points meet.

    Attributes:
        box: (2, 3), lowest and highest corner; None for no box.
        classes: Whole numbers from 0 to 255; None for all.
        returns: One of RETURNS.
    """

    box: npt.NDArray[np.float64] | None
    classes: list[int] | None
    returns: str

    def of_file(self, points: _native.PointSource, path: str) -> _native.PointSource:
        """Chosen points of a file. Raises ValueError where it lacks the classes or returns."""
        box = None if self.box is None else (self.box[0].tolist(), self.box[1].tolist())
        return _native.ChosenPoints(points, box, self.classes, self.returns, f"'{path}'")

    def of_scan(self, points: ScanPoints) -> ScanPoints:
        """Chosen points of a scan in memory."""
        positions = np.asarray(points.positions)
        chosen = np.ones(len(positions), bool)
        if self.box is not None:
            chosen &= (positions >= self.box[0]).all(axis=1) & (positions <= self.box[1]).all(
                axis=1
            )
        if self.classes is not None:
            point_classes = np.trunc(_attribute(points, _CLASS, "classes"))
            chosen &= np.isin(point_classes, np.asarray(self.classes, np.float32))
        if self.returns in ("first", "last"):
            number = np.maximum(_attribute(points, _NUMBER, "returns"), 1)
        if self.returns in ("last", "only"):
            count = np.maximum(_attribute(points, _COUNT, "returns"), 1)
        if self.returns == "first":
            chosen &= number == 1
        elif self.returns == "last":
            chosen &= number >= count
        elif self.returns == "only":
            chosen &= count == 1
        return points.take(chosen)


def as_choice(classes: Classes | None, returns: str, box: npt.ArrayLike | None) -> Choice | None:
    """The choice; None if it includes every point. Raises ValueError for a wrong value."""
    as_one_of("returns", returns, RETURNS)
    if classes is None and returns == "all" and box is None:
        return None
    return Choice(_as_box(box), _as_classes(classes), returns)


def choose_points(
    points: ScanPoints,
    *,
    classes: Classes | None = None,
    returns: str = "all",
    box: npt.ArrayLike | None = None,
) -> ScanPoints:
    """Chooses points of a scan, as `read_points` does for files.

    Args:
        points: The scan.
        classes: One class or several, 0 to 255, of the attribute "classification": 2 is ground in
            LAS files. None: all.
        returns: Echoes of a scanner's pulse: "all", the "first", the "last", or the "only" ones, by
            the attributes "return_number" and "number_of_returns", where 0 counts as 1.
        box: Lowest and highest corner, (2, 3), both included. None: no box.

    Raises:
        ValueError: A value is not allowed, or the points lack the attribute.
    """
    choice = as_choice(classes, returns, box)
    return points if choice is None else choice.of_scan(points)


def _as_box(box: npt.ArrayLike | None) -> npt.NDArray[np.float64] | None:
    if box is None:
        return None
    corners: npt.NDArray[np.float64] = as_floats("box", box, (2, 3), np.float64)
    if not (corners[0] <= corners[1]).all():
        raise ValueError(
            f"box: from {corners[0].tolist()} to {corners[1].tolist()}; the lowest corner and the "
            "highest are needed"
        )
    return corners


def _as_classes(classes: Classes | None) -> list[int] | None:
    if classes is None:
        return None
    array = np.atleast_1d(as_array("classes", classes))
    is_whole = array.dtype.kind in "iu" and array.ndim == 1 and len(array) > 0
    if not is_whole or array.min() < 0 or array.max() > _HIGHEST_CLASS:
        raise ValueError(
            f"classes: {classes!r}; whole numbers from 0 to {_HIGHEST_CLASS} are needed"
        )
    return [int(number) for number in array]


def _attribute(points: ScanPoints, name: str, option: str) -> npt.NDArray[np.float32]:
    if name not in points.attributes:
        raise ValueError(f"{option}: the points have no '{name}'")
    return np.asarray(points.attributes[name], np.float32)
