# SPDX-License-Identifier: GPL-3.0-or-later

"""Which points of files and scans are used: those of a box, of some classes, of some returns."""

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
_MOST = 255
_CLASS = "classification"
_NUMBER, _OF = "return_number", "number_of_returns"


@dataclass(frozen=True, eq=False)
class Choice:
    """What points have to be.

    Attributes:
        box: (2, 3), its lowest corner and its highest; None for no box.
        classes: Whole numbers from 0 to 255; None for all.
        returns: One of RETURNS.
    """

    box: npt.NDArray[np.float64] | None
    classes: list[int] | None
    returns: str

    def of_file(self, points: _native.PointSource, path: str) -> _native.PointSource:
        """The points of a file that it has. Raises ValueError where the file does not say."""
        box = None if self.box is None else (self.box[0].tolist(), self.box[1].tolist())
        return _native.ChosenPoints(points, box, self.classes, self.returns, f"'{path}'")

    def of_scan(self, points: ScanPoints) -> ScanPoints:
        """The same of points in memory."""
        positions = np.asarray(points.positions)
        chosen = np.ones(len(positions), bool)
        if self.box is not None:
            chosen &= (positions >= self.box[0]).all(axis=1) & (positions <= self.box[1]).all(
                axis=1
            )
        if self.classes is not None:
            found = np.trunc(_attribute(points, _CLASS, "classes"))
            chosen &= np.isin(found, np.asarray(self.classes, np.float32))
        if self.returns in ("first", "last"):
            number = np.maximum(_attribute(points, _NUMBER, "returns"), 1)
        if self.returns in ("last", "only"):
            of = np.maximum(_attribute(points, _OF, "returns"), 1)
        if self.returns == "first":
            chosen &= number == 1
        elif self.returns == "last":
            chosen &= number >= of
        elif self.returns == "only":
            chosen &= of == 1
        return points.take(chosen)


def as_choice(classes: Classes | None, returns: str, box: npt.ArrayLike | None) -> Choice | None:
    """What is chosen; None for everything. Raises ValueError for what cannot be."""
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
    """Some of the points of a scan, as `read_points` chooses them from files.

    Args:
        points: Of a scan.
        classes: One class or several, 0 to 255, of the attribute "classification": 2 is ground in
            LAS files. None: all.
        returns: Of the echoes of a scanner's pulse "all", the "first", the "last", or the "only"
            ones, by the attributes "return_number" and "number_of_returns", where 0 counts as 1.
        box: Its lowest and its highest corner, (2, 3), which belong to it. None: everywhere.

    Raises:
        ValueError: A value is not allowed, or the points do not have such an attribute.
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
    found = np.atleast_1d(as_array("classes", classes))
    is_whole = found.dtype.kind in "iu" and found.ndim == 1 and len(found) > 0
    if not is_whole or found.min() < 0 or found.max() > _MOST:
        raise ValueError(f"classes: {classes!r}; whole numbers from 0 to {_MOST} are needed")
    return [int(one) for one in found]


def _attribute(points: ScanPoints, name: str, option: str) -> npt.NDArray[np.float32]:
    if name not in points.attributes:
        raise ValueError(f"{option}: the points have no '{name}'")
    return np.asarray(points.attributes[name], np.float32)
