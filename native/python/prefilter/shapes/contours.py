# SPDX-License-Identifier: GPL-3.0-or-later

"""Contours drawn step by step: lines, Bezier curves and conics."""

from typing import cast

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import as_name, as_number
from .._border.arrays import as_array
from .arguments import as_point, as_points, check_finite

_MAX_DEGREE = 60


class Contours:
    """Contours of lines, Bezier curves and conics; coordinates are pixels.

    Pixel (i, j) is [i, i + 1) x [j, j + 1), and row 0 is the bottom row.
    """

    def __init__(self) -> None:
        self._outline = _native.Outline()
        self._has_contour = False

    @property
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """The low and the high corner of the box of all control points, which holds the shape."""
        return self._outline.bounds()

    def move_to(self, x: float, y: float) -> None:
        """Begins a contour at a point.

        Raises:
            ValueError: The point is not finite.
        """
        self._outline.move_to(*as_point("x, y", (x, y)))
        self._has_contour = True

    def line_to(self, x: float, y: float) -> None:
        """Adds a line to a point.

        Raises:
            ValueError: The point is not finite, or no contour has begun.
        """
        self._check_begun("line_to")
        self._outline.line_to(*as_point("x, y", (x, y)))

    def curve_to(self, *control_points: npt.ArrayLike) -> None:
        """Adds a Bezier curve of as many degrees as points are given.

        Args:
            control_points: One to 60 points, of which the last is the end: pairs (x, y), or the
                coordinates one after another.

        Raises:
            ValueError: The points are not as said or not finite, or no contour has begun.
        """
        self._check_begun("curve_to")
        found = as_array("control_points", cast(npt.ArrayLike, control_points))
        numbers = found.dtype.kind in "fiu"
        if not numbers or found.size % 2 or found.ndim not in (1, 2) or found.shape[-1] % 2:
            raise ValueError("control_points: found no pairs (x, y)")
        points = np.ascontiguousarray(found, np.float64).reshape(-1, 2)
        if not 1 <= len(points) <= _MAX_DEGREE:
            raise ValueError(f"control_points: {len(points)} points; 1 to {_MAX_DEGREE} are needed")
        check_finite("control_points", points)
        self._outline.curve_to(points)

    def conic_to(self, x1: float, y1: float, weight: float, x2: float, y2: float) -> None:
        """Adds a rational quadratic curve: an arc of an ellipse, a parabola or a hyperbola.

        A quarter of a circle has the corner of its tangents as (x1, y1) and the weight sqrt(1/2).

        Args:
            x1: The x of the control point in the middle.
            y1: Its y.
            weight: Its weight, above 0; the ends have 1.
            x2: The x of the end.
            y2: Its y.

        Raises:
            ValueError: A point is not finite, the weight not above 0, or no contour has begun.
        """
        self._check_begun("conic_to")
        middle, end = as_point("x1, y1", (x1, y1)), as_point("x2, y2", (x2, y2))
        number = as_number("weight", weight)
        if not 1e-6 <= number <= 1e6:
            raise ValueError(f"weight: {weight!r}; a number from 1e-6 to 1e6 is needed")
        self._outline.conic_to(*middle, number, *end)

    def close(self) -> None:
        """Closes the contour by a line to where it began, where it is not there yet."""
        self._outline.close()

    def add_polygon(self, points: npt.ArrayLike) -> None:
        """Adds a closed contour of lines.

        Args:
            points: (points, 2), at least one.

        Raises:
            ValueError: The points are not as said, or not finite.
        """
        corners = as_points("points", points, ("points", 2))
        if len(corners) == 0:
            raise ValueError("points: found none; at least one is needed")
        check_finite("points", corners)
        self._outline.add_contour(corners, 1)
        self._has_contour = True

    def add_beziers(self, points: npt.ArrayLike) -> None:
        """Adds a closed contour of Bezier curves of one degree.

        Args:
            points: (curves, degree + 1, 2): the control points of each, with a degree of 1 to 60.
                Each begins where the one before it ends; that point is taken from the one before.

        Raises:
            ValueError: The points are not as said, not finite, or a curve does not begin where the
                one before it ends.
        """
        controls = as_points("points", points, ("curves", "points", 2))
        degree = controls.shape[1] - 1
        if len(controls) == 0 or not 1 <= degree <= _MAX_DEGREE:
            raise ValueError(
                f"points: shape {controls.shape}; at least one curve of 2 to {_MAX_DEGREE + 1} "
                "points is needed"
            )
        check_finite("points", controls)
        broken = np.flatnonzero((controls[1:, 0] != controls[:-1, -1]).any(1))
        if len(broken):
            raise ValueError(
                f"points: curve {broken[0] + 1} does not begin where the one before it ends"
            )
        chain = np.concatenate([controls[0, :1], controls[:, 1:].reshape(-1, 2)])
        self._outline.add_contour(np.ascontiguousarray(chain), degree)
        self._has_contour = True

    def add_path(self, letters: str, numbers: npt.ArrayLike) -> None:
        """Adds contours of all kinds of segments at once, which is quicker than one by one.

        Args:
            letters: One for each step: M moves, L adds a line, Q and C Bezier curves of degree 2
                and 3, W a conic, and Z closes. The first is M.
            numbers: What the steps take, one after another: for each the coordinates of the points
                behind the one where it begins; W has its weight between the two.

        Raises:
            ValueError: There is another letter, too few or too many numbers, one that is not
                finite, or a weight not from 1e-6 to 1e6.
        """
        steps = as_name("letters", letters)
        found = as_array("numbers", numbers)
        if found.ndim != 1 or (found.size and found.dtype.kind not in "fiu"):
            raise ValueError(f"numbers: shape {found.shape}; a row of numbers is needed")
        values = np.ascontiguousarray(found, np.float64)
        if not np.isfinite(values).all():
            raise ValueError("numbers: one is not finite")
        self._outline.add_path(steps, values)
        self._has_contour = self._has_contour or bool(steps)

    def _check_begun(self, what: str) -> None:
        if not self._has_contour:
            raise ValueError(f"{what}: no contour has begun; call move_to first")
