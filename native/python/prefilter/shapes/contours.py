# SPDX-License-Identifier: GPL-3.0-or-later

"""Contours of lines, Bezier curves and conics, built segment by segment."""

from typing import cast

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import as_name, as_number
from .._border.arrays import as_array
from .arguments import as_point, as_points, check_finite

_MAX_DEGREE = 60


class Contours:
    """Contours of lines, Bezier curves and conics, in pixels.

    Pixel (i, j) is [i, i + 1) x [j, j + 1), and row 0 is the bottom row.
    """

    def __init__(self) -> None:
        self._outline = _native.Outline()
        self._has_contour = False

    @property
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """Low and high corner of the bounding box of all control points."""
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
        """Adds a Bezier curve; its degree is the number of points.

        Args:
            control_points: One to 60 points, the last of which is the end: pairs (x, y), or a flat
                list of coordinates.

        Raises:
            ValueError: The points are invalid or not finite, or no contour has begun.
        """
        self._check_begun("curve_to")
        array = as_array("control_points", cast(npt.ArrayLike, control_points))
        numbers = array.dtype.kind in "fiu"
        if not numbers or array.size % 2 or array.ndim not in (1, 2) or array.shape[-1] % 2:
            raise ValueError("control_points: found no pairs (x, y)")
        points = np.ascontiguousarray(array, np.float64).reshape(-1, 2)
        if not 1 <= len(points) <= _MAX_DEGREE:
            raise ValueError(f"control_points: {len(points)} points; 1 to {_MAX_DEGREE} are needed")
        check_finite("control_points", points)
        self._outline.curve_to(points)

    def conic_to(self, x1: float, y1: float, weight: float, x2: float, y2: float) -> None:
        """Adds a rational quadratic curve: an arc of an ellipse, a parabola or a hyperbola.

        For a quarter of a circle, (x1, y1) is the intersection of the tangents, and the weight is
        sqrt(1/2).

        Args:
            x1: x of the middle control point.
            y1: y of the middle control point.
            weight: Its weight, above 0; the end points have weight 1.
            x2: x of the end.
            y2: y of the end.

        Raises:
            ValueError: A point is not finite, the weight is not positive, or no contour has begun.
        """
        self._check_begun("conic_to")
        middle, end = as_point("x1, y1", (x1, y1)), as_point("x2, y2", (x2, y2))
        number = as_number("weight", weight)
        if not 1e-6 <= number <= 1e6:
            raise ValueError(f"weight: {weight!r}; a number from 1e-6 to 1e6 is needed")
        self._outline.conic_to(*middle, number, *end)

    def close(self) -> None:
        """Closes the contour by a line to its start."""
        self._outline.close()

    def add_polygon(self, points: npt.ArrayLike) -> None:
        """Adds a closed polygon.

        Args:
            points: (points, 2), at least one.

        Raises:
            ValueError: The points are invalid or not finite.
        """
        corners = as_points("points", points, ("points", 2))
        if len(corners) == 0:
            raise ValueError("points: found none; at least one is needed")
        check_finite("points", corners)
        self._outline.add_contour(corners, 1)
        self._has_contour = True

    def add_beziers(self, points: npt.ArrayLike) -> None:
        """Adds a closed contour of Bezier curves of the same degree.

        Args:
            points: (curves, degree + 1, 2): control points of each curve, with a degree of 1 to 60.
                Each curve begins at the end of the previous one.

        Raises:
            ValueError: The points are invalid or not finite, or a curve does not begin at the end
                of the previous one.
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
        """Adds contours of several kinds of segments at once, which is faster than one by one.

        Args:
            letters: One per segment: M moves, L adds a line, Q and C Bezier curves of degree 2 and
                3, W a conic, and Z closes. The first is M.
            numbers: Coordinates of all segments, each without its start point; W has its weight
                between its two points.

        Raises:
            ValueError: A letter is unknown, the number of coordinates does not match, one is not
                finite, or a weight is not in [1e-6, 1e6].
        """
        steps = as_name("letters", letters)
        array = as_array("numbers", numbers)
        if array.ndim != 1 or (array.size and array.dtype.kind not in "fiu"):
            raise ValueError(f"numbers: shape {array.shape}; a row of numbers is needed")
        values = np.ascontiguousarray(array, np.float64)
        if not np.isfinite(values).all():
            raise ValueError("numbers: one is not finite")
        self._outline.add_path(steps, values)
        self._has_contour = self._has_contour or bool(steps)

    def _check_begun(self, what: str) -> None:
        if not self._has_contour:
            raise ValueError(f"{what}: no contour has begun; call move_to first")
