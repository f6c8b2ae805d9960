# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of a surface, as scanners give them."""

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_int, as_name, as_progress, progress_part
from .._border.arrays import as_array, as_floats, as_indices, as_threads
from .._border.names import Upward

_HUGE = 1e30
_HUGE_PER_OTHER = 100
"""As in native/prefilter/points/reconstruct/gather_samples.cpp."""


def estimate_normals(
    points: npt.ArrayLike,
    *,
    neighbours: int = 16,
    viewpoint: npt.ArrayLike | None = None,
    direction: Upward = "auto",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float64]:
    """The normals of points on a surface, from the planes that fit the points around each best.

    Args:
        points: (points, 3).
        neighbours: How many points around each (itself included) the plane is fitted to, 3 to 1000.
            More are better for noisy points, fewer for fine detail: the neighborhood should be
            several times as wide as the noise. Copies of a point count once.
        viewpoint: Where the scanner stood, (3,), or one place for each point, (points, 3): normals
            point to it. Without, `direction` says where.
        direction: "outward": normals agree with those around them, and those of each connected part
            point outward as a whole, as those of a closed surface do. "up": they point to where z
            is larger; those that are nearly level, as of walls, agree with those around them.
            "auto": to the origin where the points were seen from there, as from a camera or in a
            room: where rays from it meet their surface once, and they are spread over directions as
            a scanner spreads them. Else up where the points are a height field, as of a terrain:
            where few of them have another sheet of the surface above or below them, or are on a
            wall. Else outward.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (points, 3) float64, 1 long. They are zero for points that stand for nothing that was seen:
        that hold a value that is not finite, above 1e150, or from 1e30 where that of most others is
        not, and many points at one position, such as 0, 0, 0; and for all where fewer than three
        points are left or all coincide.

    Raises:
        ValueError: A shape or type is wrong, there are no points, `neighbours` is out of range, or
            a viewpoint is not finite; there is no such direction.
        Cancelled: `progress` returned False.
    """
    rows = as_floats("points", points, ("points", 3), np.float64)
    viewpoints = as_viewpoints(viewpoint)
    side = as_name("direction", direction)
    used = as_threads(threads)
    rows = seen_points(rows, progress_part(progress, 0.0, 0.05), used)
    if side == "auto":
        side = "outward"
        if len(viewpoints) == 0:
            side, _ = side_of(rows, progress_part(progress, 0.05, 0.1), used)
    if side == "viewpoint":
        side, viewpoints = "outward", np.zeros((1, 3))
    progress = progress_part(progress, 0.1, 1.0)
    return _native.estimate_normals(
        rows,
        as_int("neighbours", neighbours, "a whole number from 3 to 1000 is needed"),
        viewpoints,
        side,
        as_progress(progress),
        used,
    )


def side_of(
    points: npt.NDArray[np.float64], progress: ProgressCallback | None, threads: int
) -> tuple[str, str]:
    """The direction of normals of points of which nothing else is known.

    Returns:
        "viewpoint", for the origin, "up" or "outward"; and what the origin is to the points:
        "scanner", "either", for a scanner in a room or the middle of an object, or "none".
    """
    origin = _native.origin_role(points, as_progress(progress_part(progress, 0.0, 0.7)), threads)
    if origin == "scanner":
        return "viewpoint", origin
    rest = as_progress(progress_part(progress, 0.7, 1.0))
    return "up" if _native.is_height_field(points, rest) else "outward", origin


def seen_points(
    points: npt.NDArray[np.float64], progress: ProgressCallback | None, threads: int
) -> npt.NDArray[np.float64]:
    """The points, with NaN in place of those that stand for nothing that was seen.

    These are huge coordinates, where most are not, and many points at one position.
    """
    finite = np.isfinite(points).all(axis=1)
    huge = finite & (np.abs(points) >= _HUGE).any(axis=1)
    others = np.count_nonzero(finite & ~huge)
    unseen = np.zeros(len(points), bool)
    if np.count_nonzero(huge) <= _HUGE_PER_OTHER * others:
        unseen |= huge
    for position, _ in _native.find_phantoms(points, as_progress(progress), threads):
        unseen |= np.asarray((points == np.array(position)).all(axis=1))
    return np.where(unseen[:, None], np.nan, points) if unseen.any() else points


def mesh_normals(
    points: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    progress: ProgressCallback | None = None,
) -> npt.NDArray[np.float64]:
    """The normals of points that triangles connect: the mean of those of the triangles, by area.

    Args:
        points: (points, 3).
        triangles: (triangles, 3) integer indices of points, counter-clockwise seen from outside.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        (points, 3) float64, 1 long; zero for points without triangles that have a normal.

    Raises:
        ValueError: A shape or type is wrong, or an index names no point.
        Cancelled: `progress` returned False.
    """
    return _native.mesh_normals(
        as_floats("points", points, ("points", 3), np.float64),
        as_indices("triangles", triangles, ("triangles", 3)),
        as_progress(progress),
    )


def grid_normals(
    points: npt.ArrayLike,
    grid: npt.ArrayLike,
    *,
    viewpoint: npt.ArrayLike | None = None,
    progress: ProgressCallback | None = None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float32]]:
    """The normals of points that a scanner saw in a grid, from the triangles between neighbors.

    Triangles with an edge over four times as long as usual would join a surface to what is behind
    it, and are left out.

    Args:
        points: (points, 3), as the scanner saw them: not yet moved to where other scans are.
        grid: (rows, columns) integer indices of points, -1 for none; `read_range_grid` reads them.
        viewpoint: Where the scanner stood, (3,): the side that shows more to it is outside. None
            stands for far away where z is large, as with the scanners of Stanford's range scans.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        Normals, (points, 3) float64, 1 long, zero for points without neighbors; and weights,
        (points,) float32 in [0, 1], which are lower where the surface was seen at an angle and
        within six places of where it ends.

    Raises:
        ValueError: A shape or type is wrong, an index names no point, or the viewpoint is not
            finite.
        Cancelled: `progress` returned False.
    """
    return _native.grid_normals(
        as_floats("points", points, ("points", 3), np.float64),
        as_indices("grid", grid, ("rows", "columns")),
        None if viewpoint is None else as_floats("viewpoint", viewpoint, (3,), np.float64).tolist(),
        as_progress(progress),
    )


def as_viewpoints(viewpoint: npt.ArrayLike | None) -> npt.NDArray[np.float64]:
    if viewpoint is None:
        return np.empty((0, 3))
    found = as_array("viewpoint", viewpoint)
    if found.ndim == 1:
        return as_floats("viewpoint", found, (3,), np.float64).reshape(1, 3)
    rows = as_floats("viewpoint", found, ("points", 3), np.float64)
    if len(rows) == 0:
        raise ValueError("viewpoint: shape (0, 3); one for all points or one for each is needed")
    return rows
