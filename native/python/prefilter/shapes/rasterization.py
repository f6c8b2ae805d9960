# SPDX-License-Identifier: GPL-3.0-or-later

"""Vector shapes, and their images."""

from collections.abc import Iterable, Sequence
from typing import cast

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    ProgressCallback,
    as_int,
    as_name,
    as_number,
    as_progress,
    as_size,
)
from .._border.arrays import FloatArray, as_array, as_floats, as_threads

RASTER_FILTERS: tuple[str, ...] = tuple(_native.raster_filters())
Stop = tuple[float, Sequence[float]]
_MOST_DEGREE = 60
_MOST_CHANNELS = 4
_FILL_RULES = ("nonzero", "evenodd")


class Shape:
    """What an outline encloses, with a color: contours of lines, Bezier curves and conics.

    Coordinates are pixels; pixel (i, j) is [i, i + 1) x [j, j + 1), and row 0 is the bottom row. A
    contour that is left open is filled as if a line closed it.

    Args:
        fill_rule: Which points are inside: "nonzero", where contours wind round a point a number of
            times that is not 0, or "evenodd", where that number is odd.
        color: One to four values, which a pixel takes as far as the shape covers it. Four are
            red, green and blue multiplied by alpha, and alpha. Filtering needs scene-linear
            values.
        winds_once: Contours are known to wind once, counter-clockwise, round what they fill. No
            overlaps are looked for then, which saves time where there are many curves; where there
            are some, a place counts as often as contours wind round it.

    Raises:
        ValueError: `fill_rule` is no such name, or `color` not one to four finite numbers.
    """

    def __init__(
        self,
        fill_rule: str = "nonzero",
        color: Sequence[float] = (1.0,),
        *,
        winds_once: bool = False,
    ) -> None:
        name = as_name("fill_rule", fill_rule)
        if name not in _FILL_RULES:
            raise ValueError(f"fill_rule: '{name}' is not one of {', '.join(_FILL_RULES)}")
        self._fill_rule = name
        self._winds_once = bool(winds_once)
        self._outline = _native.Outline()
        self._has_contour = False
        self.color = color

    @property
    def fill_rule(self) -> str:
        return self._fill_rule

    @property
    def channels(self) -> int:
        """The number of values that its color has."""
        return self._channels

    @property
    def color(self) -> tuple[float, ...] | None:
        """The values everywhere inside, or None where a gradient has been set."""
        return self._color

    @color.setter
    def color(self, color: Sequence[float]) -> None:
        values = _as_color("color", color)
        none = [0.0] * len(values)
        self._paint = _native.Paint(list(values), none, none)
        self._color: tuple[float, ...] | None = values
        self._channels = len(values)

    @property
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """The low and the high corner of the box of all control points, which holds the shape."""
        return self._outline.bounds()

    def gradient(
        self, value: Sequence[float], along_x: Sequence[float], along_y: Sequence[float]
    ) -> None:
        """Colors the shape by value + x * along_x + y * along_y at (x, y).

        Args:
            value: One to four values at the origin, as `color` has them.
            along_x: What they change by in a pixel along x.
            along_y: What they change by in a pixel along y.

        Raises:
            ValueError: The three are not as long as each other, or not finite.
        """
        values = _as_color("value", value)
        slopes = _as_color("along_x", along_x), _as_color("along_y", along_y)
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
        """Colors the shape along a line.

        Args:
            start: The point (x, y) of offset 0.
            end: The point of offset 1; another one.
            stops: Pairs (offset, color) with rising offsets in [0, 1]; between two of them colors
                change linearly. At least one.
            spread: What comes before offset 0 and after 1: "pad", the outermost colors; "repeat";
                or "reflect", there and back.
            transform: (2, 3), from the coordinates of `start` and `end` to those of the shape.

        Raises:
            ValueError: An argument is not as said.
        """
        begin, finish = _as_point("start", start), _as_point("end", end)
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
        """Colors the shape from a focus outwards.

        Within a pixel the color is taken for a polynomial of degree 2: where it jumps at a stop, a
        pixel may be some hundredths off.

        Args:
            center: The center (x, y) of the circle of offset 1.
            radius: Its radius, above 0.
            stops: As for `linear_gradient`.
            focus: The center of the circle of offset 0; None for `center`.
            focus_radius: Its radius, 0 or above.
            spread: As for `linear_gradient`.
            transform: As for `linear_gradient`.

        Raises:
            ValueError: An argument is not as said.
        """
        middle = _as_point("center", center)
        size, inner = as_number("radius", radius), as_number("focus_radius", focus_radius)
        if not 0.0 < size < np.inf:
            raise ValueError(f"radius: {radius!r}; a finite number above 0 is needed")
        if not 0.0 <= inner < np.inf:
            raise ValueError(f"focus_radius: {focus_radius!r}; a finite number of at least 0")
        begin = middle if focus is None else _as_point("focus", focus)
        self._set_stops(True, begin, inner, middle, size, stops, spread, transform)

    def move_to(self, x: float, y: float) -> None:
        """Begins a contour at a point.

        Raises:
            ValueError: The point is not finite.
        """
        self._outline.move_to(*_as_point("x, y", (x, y)))
        self._has_contour = True

    def line_to(self, x: float, y: float) -> None:
        """Adds a line to a point.

        Raises:
            ValueError: The point is not finite, or no contour has begun.
        """
        self._check_begun("line_to")
        self._outline.line_to(*_as_point("x, y", (x, y)))

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
        if not 1 <= len(points) <= _MOST_DEGREE:
            raise ValueError(
                f"control_points: {len(points)} points; 1 to {_MOST_DEGREE} are needed"
            )
        _check_finite("control_points", points)
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
        middle, end = _as_point("x1, y1", (x1, y1)), _as_point("x2, y2", (x2, y2))
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
        corners = _as_points("points", points, ("points", 2))
        if len(corners) == 0:
            raise ValueError("points: found none; at least one is needed")
        _check_finite("points", corners)
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
        controls = _as_points("points", points, ("curves", "points", 2))
        degree = controls.shape[1] - 1
        if len(controls) == 0 or not 1 <= degree <= _MOST_DEGREE:
            raise ValueError(
                f"points: shape {controls.shape}; at least one curve of 2 to {_MOST_DEGREE + 1} "
                "points is needed"
            )
        _check_finite("points", controls)
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

    def transformed(self, matrix: npt.ArrayLike) -> "Shape":
        """The shape where an affine map puts it; its color goes along.

        Args:
            matrix: (2, 3): a point (x, y) goes to matrix @ (x, y, 1). Of rank 2.

        Raises:
            ValueError: `matrix` is not as said.
        """
        numbers = _as_matrix("matrix", matrix)
        moved = self._with(self._outline.transformed(numbers), self._paint.transformed(numbers))
        # What a map turns over winds the other way.
        moved._winds_once = self._winds_once and _determinant(numbers) > 0.0
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
        """What a pen covers along the contours, with the same color. Lengths are pixels.

        Args:
            width: The pen's, 0 or more.
            join: What fills the gap outside of a corner: "miter", "round" or "bevel".
            cap: How open contours and dashes end: "butt", "round" or "square".
            miter_limit: A miter longer than this, in widths, becomes a bevel; 1 or more.
            dashes: Lengths along the curve of dashes and gaps in turns; none for a solid stroke. An
                odd number of them is gone through twice. Every contour begins anew.
            dash_offset: How far into the dashes a contour begins.
            tolerance: How far off curves beside curves may be, above 0. Lines stay lines, and round
                joins and caps are arcs.

        Raises:
            ValueError: An argument is not as said.
        """
        pattern = as_array("dashes", dashes)
        if pattern.ndim != 1 or (pattern.size and pattern.dtype.kind not in "fiu"):
            raise ValueError(f"dashes: {dashes!r}; lengths are needed")
        reach = as_number("tolerance", tolerance)
        if not 0.0 < reach < np.inf:
            raise ValueError(f"tolerance: {tolerance!r}; a finite number above 0 is needed")
        outline = self._outline.stroked(
            as_number("width", width),
            as_name("join", join),
            as_name("cap", cap),
            as_number("miter_limit", miter_limit),
            [float(length) for length in pattern],
            as_number("dash_offset", dash_offset),
            reach,
        )
        drawn = self._with(outline, self._paint)
        drawn._fill_rule, drawn._winds_once = "nonzero", True
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

    def _check_begun(self, what: str) -> None:
        if not self._has_contour:
            raise ValueError(f"{what}: no contour has begun; call move_to first")

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
        pairs = _as_stops(stops)
        matrix = _as_matrix("transform", np.eye(2, 3) if transform is None else transform)
        name = as_name("spread", spread)
        self._paint = _native.Paint(
            is_radial, start, start_radius, end, end_radius, pairs, name, matrix
        )
        self._color = None
        self._channels = len(pairs[0][1])


def rasterize(
    shapes: Iterable[Shape],
    width: int,
    height: int,
    *,
    filter: str = "box",
    method: str = "scanline",
    depth: int | None = None,
    background: Sequence[float] | None = None,
    overlap: str = "cover",
    dtype: npt.DTypeLike = np.float32,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FloatArray | npt.NDArray[np.uint8]:
    """The image of shapes, each pixel the mean around its center by a filter (chapter 2).

    The means are closed forms of the outlines as they are: no curve is made of lines, and no point
    is sampled. Lines and curves are exact to rounding; arcs of conics are to 1e-7 of the value.

    Args:
        shapes: What to draw, with as many channels each; see `Shape`.
        width: Pixels.
        height: Pixels.
        filter: "box" (what a pixel covers), "tent", "bspline2", "mitchell", "lanczos2", "lanczos3",
            "gaussian" (exp(-pi r^2)); or "radial2", "radial3", windowed jincs, of which frequencies
            of any direction are alike. All have an integral of 1; those from "mitchell" to
            "lanczos3", and the radial ones, have negative lobes, so values may leave the range of
            the colors.
        method: "scanline" (section 2.2), or "wavelet" (chapter 3), for the box filter and constant
            colors only. Both give the same image of closed contours. "wavelet" leaves open ones
            open, unless shapes cover each other: a gap changes values near it, and not the rows
            beside it. Of a shape that has one the winding numbers are drawn, whatever its fill
            rule.
        depth: Of "wavelet": where to end. The square of the smallest power of two that holds the
            image is halved so many times, and each pixel gets the mean over the cell that it is in.
            0 is one cell for all; None ends at pixels.
        background: What is behind the shapes, as many values as they have; None for 0.
        overlap: "cover": later shapes cover those before them, with four channels as far as alpha
            says. "add": the values of all shapes are summed, so that shapes that share an edge have
            no seam.
        dtype: float32, or uint8 for values from 0 to 1 as 0 to 255, rounded.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (height, width, channels), row 0 at the bottom. Where there are no shapes, as many channels
        as the background has, or one.

    Raises:
        ValueError: A name is none of those, shapes differ in their channels, a point is more than
            1e9 pixels away, a size is below 1, or the method has no such filter, color or depth.
        MemoryError: The image does not fit into memory.
        Cancelled: `progress` returned False.
    """
    try:
        drawn = list(shapes)
    except TypeError as error:
        raise ValueError(f"shapes: {shapes!r}; several of Shape are needed") from error
    for index, shape in enumerate(drawn):
        if not isinstance(shape, Shape):
            raise ValueError(f"shapes: item {index} is {type(shape).__name__}; Shape is needed")
    channels = drawn[0].channels if drawn else 1
    behind: tuple[float, ...] = ()
    if background is not None:
        behind = _as_color("background", background)
        if len(behind) != channels and drawn:
            raise ValueError(f"background: {len(behind)} values; {channels}, as the shapes have")
    try:
        is_bytes = {"float32": False, "uint8": True}[np.dtype(dtype).name]
    except (KeyError, TypeError) as error:
        raise ValueError(f"dtype: {dtype!r} is not one of float32, uint8") from error
    image = _native.rasterize(
        [(shape._outline, shape._fill_rule, shape._paint, shape._winds_once) for shape in drawn],
        as_size("width", width),
        as_size("height", height),
        as_name("filter", filter),
        as_name("method", method),
        as_name("overlap", overlap),
        behind,
        _as_depth(depth),
        as_progress(progress),
        as_threads(threads),
    )
    if is_bytes:
        levels: FloatArray = np.clip(image, 0.0, 1.0) * np.float32(255.0)
        return np.rint(levels).astype(np.uint8)
    return image


def _as_depth(depth: int | None) -> int:
    if depth is None:
        return -1
    needed = "a whole number of at least 0 is needed, or None"
    number = as_int("depth", depth, needed)
    if number < 0:
        raise ValueError(f"depth: {depth!r}; {needed}")
    return number


def _as_color(name: str, color: Sequence[float]) -> tuple[float, ...]:
    found = as_array(name, color)
    if found.ndim != 1 or not 1 <= found.size <= _MOST_CHANNELS or found.dtype.kind not in "fiu":
        raise ValueError(f"{name}: {color!r}; one to {_MOST_CHANNELS} numbers are needed")
    if not np.isfinite(found).all():
        raise ValueError(f"{name}: {color!r}; finite numbers are needed")
    return tuple(float(value) for value in found)


def _as_point(name: str, point: Sequence[float]) -> tuple[float, float]:
    found = as_array(name, point)
    if found.shape != (2,) or found.dtype.kind not in "fiu" or not np.isfinite(found).all():
        raise ValueError(f"{name}: {point!r}; a pair of finite numbers is needed")
    return float(found[0]), float(found[1])


def _as_points(name: str, points: npt.ArrayLike, shape: Sequence[int | str]) -> np.ndarray:
    return as_floats(name, points, shape, np.float64)


def _check_finite(name: str, points: np.ndarray) -> None:
    if not np.isfinite(points).all():
        raise ValueError(f"{name}: a coordinate is not finite")


def _as_matrix(name: str, matrix: npt.ArrayLike) -> list[float]:
    found = as_array(name, matrix)
    if found.shape != (2, 3) or found.dtype.kind not in "fiu" or not np.isfinite(found).all():
        raise ValueError(f"{name}: shape {found.shape}; (2, 3) of finite numbers is needed")
    numbers = [float(number) for number in found.ravel()]
    if _determinant(numbers) == 0.0:
        raise ValueError(f"{name}: maps the plane to a line; a matrix of rank 2 is needed")
    return numbers


def _determinant(matrix: Sequence[float]) -> float:
    return matrix[0] * matrix[4] - matrix[1] * matrix[3]


def _as_stops(stops: Iterable[Stop]) -> list[tuple[float, list[float]]]:
    try:
        found = [(offset, color) for offset, color in stops]
    except (TypeError, ValueError) as error:
        raise ValueError("stops: pairs (offset, color) are needed") from error
    if not found:
        raise ValueError("stops: found none; at least one is needed")
    pairs: list[tuple[float, list[float]]] = []
    for offset, color in found:
        number = as_number("stops: offset", offset)
        if not 0.0 <= number <= 1.0 or (pairs and number < pairs[-1][0]):
            raise ValueError(f"stops: offset {offset!r}; rising numbers in [0, 1] are needed")
        values = list(_as_color("stops: color", color))
        if pairs and len(values) != len(pairs[0][1]):
            raise ValueError("stops: colors with as many values each are needed")
        pairs.append((number, values))
    return pairs
