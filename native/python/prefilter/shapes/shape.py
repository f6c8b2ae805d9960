# SPDX-License-Identifier: GPL-3.0-or-later

"""Shapes: contours with a fill rule and a paint."""

from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import Check, as_name, as_number, as_one_of, set_options
from .._border.arrays import as_array
from .arguments import Stop, as_color, as_matrix, as_point, as_stops, determinant
from .contours import Contours


def _as_dashes(dashes: Sequence[float]) -> list[float]:
    pattern = as_array("dashes", dashes)
    if pattern.ndim != 1 or (pattern.size and pattern.dtype.kind not in "fiu"):
        raise ValueError(f"dashes: {dashes!r}; lengths are needed")
    return [float(length) for length in pattern]


_STROKE_CHECKS: dict[str, Check] = {
    "width": partial(as_number, "width"),
    "join": partial(as_name, "join"),
    "cap": partial(as_name, "cap"),
    "miter_limit": partial(as_number, "miter_limit"),
    "dashes": _as_dashes,
    "dash_offset": partial(as_number, "dash_offset"),
}


class Shape(Contours):
    """The interior of contours, with a color or gradient.

    Coordinates are in pixels; pixel (i, j) is [i, i + 1) x [j, j + 1), and row 0 is the bottom row.
    Open contours are filled as if closed by a line.

    Args:
        fill_rule: Points inside: "nonzero" if the winding number of the contours is not 0, or
            "evenodd" if it is odd.
        color: One to four values, weighted by coverage. Four are red, green and blue premultiplied
            by alpha, and alpha. Filtering needs scene-linear values.
        winds_once: The contours are known to wind once, counter-clockwise, around their interior.
            Overlaps are not searched for, which saves time with many curves; points inside overlaps
            would count as often as contours wind around them.

    Raises:
        ValueError: `fill_rule` is unknown, or `color` is not one to four finite numbers.
    """

    def __init__(
        self,
        fill_rule: str = "nonzero",
        color: Sequence[float] = (1.0,),
        *,
        winds_once: bool = False,
    ) -> None:
        super().__init__()
        name = as_name("fill_rule", fill_rule)
        self._fill_rule = as_one_of("fill_rule", name, _native.FILL_RULES)
        self._winds_once = bool(winds_once)
        self.color = color

    @property
    def fill_rule(self) -> str:
        return self._fill_rule

    @property
    def channels(self) -> int:
        """The number of values of its color."""
        return self._channels

    @property
    def color(self) -> tuple[float, ...] | None:
        """The values everywhere inside; None with a gradient."""
        return self._color

    @color.setter
    def color(self, color: Sequence[float]) -> None:
        values = as_color("color", color)
        none = [0.0] * len(values)
        self._paint = _native.Paint(list(values), none, none)
        self._color: tuple[float, ...] | None = values
        self._channels = len(values)

    def gradient(
        self, value: Sequence[float], along_x: Sequence[float], along_y: Sequence[float]
    ) -> None:
        """Sets the color value + x * along_x + y * along_y at (x, y).

        Args:
            value: One to four values at the origin; see `color`.
            along_x: Change of the values per pixel along x.
            along_y: Change of the values per pixel along y.

        Raises:
            ValueError: The lengths differ, or a number is not finite.
        """
        values = as_color("value", value)
        slopes = as_color("along_x", along_x), as_color("along_y", along_y)
        for name, slope in zip(("along_x", "along_y"), slopes, strict=True):
            if len(slope) != len(values):
                raise ValueError(f"{name}: {len(slope)} values; {len(values)}, as value has")
        self._paint = _native.Paint(list(values), list(slopes[0]), list(slopes[1]))
        self._color = None
        self._channels = len(values)

    def linear_gradient(
        self,
        start: Sequence[float],
        end: Sequence[float],
        stops: Iterable[Stop],
        *,
        spread: str = "pad",
        transform: npt.ArrayLike | None = None,
    ) -> None:
        """Sets a linear gradient.

        Args:
            start: The point (x, y) of offset 0.
            end: The point of offset 1, different from `start`.
            stops: Pairs (offset, color) with increasing offsets in [0, 1], at least one. Colors are
                interpolated linearly.
            spread: Colors before offset 0 and after 1: "pad" extends the outermost ones, "repeat"
                repeats the gradient, "reflect" alternates its direction.
            transform: (2, 3), from the coordinates of `start` and `end` to the shape's.

        Raises:
            ValueError: An argument is invalid.
        """
        begin, finish = as_point("start", start), as_point("end", end)
        if begin == finish:
            raise ValueError(f"end: {finish}; another point than start is needed")
        self._set_stops(False, begin, 0.0, finish, 0.0, stops, spread, transform)

    def radial_gradient(
        self,
        center: Sequence[float],
        radius: float,
        stops: Iterable[Stop],
        *,
        focus: Sequence[float] | None = None,
        focus_radius: float = 0.0,
        spread: str = "pad",
        transform: npt.ArrayLike | None = None,
    ) -> None:
        """Sets a radial gradient between two circles.

        If neither circle contains the other, the gradient covers a cone; outside it, a shape with
        alpha is transparent.

        Pixels average the colors of several points, also on both sides of a discontinuous stop.

        Args:
            center: Center (x, y) of the circle of offset 1.
            radius: Its radius, positive.
            stops: See `linear_gradient`.
            focus: Center of the circle of offset 0; None for `center`.
            focus_radius: Its radius, 0 or more.
            spread: See `linear_gradient`.
            transform: See `linear_gradient`.

        Raises:
            ValueError: An argument is invalid.
        """
        middle = as_point("center", center)
        size, inner = as_number("radius", radius), as_number("focus_radius", focus_radius)
        if not 0.0 < size < np.inf:
            raise ValueError(f"radius: {radius!r}; a finite number above 0 is needed")
        if not 0.0 <= inner < np.inf:
            raise ValueError(f"focus_radius: {focus_radius!r}; a finite number of at least 0")
        begin = middle if focus is None else as_point("focus", focus)
        self._set_stops(True, begin, inner, middle, size, stops, spread, transform)

    def transformed(self, matrix: npt.ArrayLike) -> "Shape":
        """Returns the shape under an affine map, with its color.

        Args:
            matrix: (2, 3), of rank 2: maps a point (x, y) to matrix @ (x, y, 1).

        Raises:
            ValueError: `matrix` is invalid.
        """
        numbers = as_matrix("matrix", matrix)
        moved = self._with(self._outline.transformed(numbers), self._paint.transformed(numbers))
        # Reflections reverse the winding.
        moved._winds_once = self._winds_once and determinant(numbers) > 0.0
        return moved

    def stroked(
        self,
        width: float,
        *,
        join: str = "miter",
        cap: str = "butt",
        miter_limit: float = 4.0,
        dashes: Sequence[float] = (),
        dash_offset: float = 0.0,
        tolerance: float = 1e-3,
    ) -> "Shape":
        """Returns the stroke of the contours, with the same color. Lengths are in pixels.

        Args:
            width: Stroke width, 0 or more.
            join: Joins at corners: "miter", "round" or "bevel".
            cap: Ends of open contours and dashes: "butt", "round" or "square".
            miter_limit: Miters longer than this many widths become bevels; 1 or more.
            dashes: Alternating lengths of dashes and gaps along the curve; empty for a solid
                stroke. An odd number of lengths is repeated once. Each contour starts anew.
            dash_offset: Distance into the dashes at which contours start.
            tolerance: Largest error of offset curves, positive. Lines stay lines, and round joins
                and caps are arcs.

        Raises:
            ValueError: An argument is invalid.
        """
        defaults = Shape.stroked.__kwdefaults__
        pen = set_options(_native.StrokeOptions(), _STROKE_CHECKS, locals(), defaults)
        reach = as_number("tolerance", tolerance)
        if not 0.0 < reach < np.inf:
            raise ValueError(f"tolerance: {tolerance!r}; a finite number above 0 is needed")
        outline, winds_once = self._outline.stroked(pen, reach)
        drawn = self._with(outline, self._paint)
        drawn._fill_rule, drawn._winds_once = "nonzero", winds_once
        return drawn

    def _with(self, outline: _native.Outline, paint: _native.Paint) -> "Shape":
        shape = Shape.__new__(Shape)
        shape.__dict__.update(self.__dict__)
        shape._outline, shape._paint = outline, paint
        return shape

    def __copy__(self) -> "Shape":
        return self._with(self._outline.copy(), self._paint)

    def __deepcopy__(self, memo: object) -> "Shape":
        return self.__copy__()

    def _set_stops(
        self,
        is_radial: bool,
        start: tuple[float, float],
        start_radius: float,
        end: tuple[float, float],
        end_radius: float,
        stops: Iterable[Stop],
        spread: str,
        transform: npt.ArrayLike | None,
    ) -> None:
        pairs = as_stops(stops)
        matrix = as_matrix("transform", np.eye(2, 3) if transform is None else transform)
        name = as_name("spread", spread)
        self._paint = _native.Paint(
            is_radial, start, start_radius, end, end_radius, pairs, name, matrix
        )
        self._color = None
        self._channels = len(pairs[0][1])
