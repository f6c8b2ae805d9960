# SPDX-License-Identifier: GPL-3.0-or-later

"""Normals of points on a surface: estimated, or from meshes and scanners' grids."""

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_int, as_name, as_progress, progress_part
from .._border.arrays import as_array, as_floats, as_indices, as_threads
from .._border.names import Upward

_HUGE = 1e30
_MAX_HUGE_PER_OTHER = 100
"""Same values as in gather_samples.cpp of the library."""


def estimate_normals(
    points: npt.ArrayLike,
    *,
    neighbours: int = 16,
    viewpoint: npt.ArrayLike | None = None,
    direction: Upward = "auto",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float64]:
    """Estimates normals of points on a surface, from the best-fitting plane around each point.

    Args:
        points: (points, 3).
        neighbours: How many points around each (itself included) the plane is fitted to, 3 to 1000.
            More are better for noisy points, fewer for fine detail: the neighborhood should be
            several times as wide as the noise. Copies of a point count once.
        viewpoint: Position of the scanner, (3,), or one for each point, (points, 3): normals point
            to it. None: `direction` decides.
        direction: "outward": normals agree with their neighbors, and those of each connected part
            point outward as a whole, as on a closed surface. "up": to larger z; nearly horizontal
            normals, as of walls, agree with their neighbors. "auto": to the origin if the points
            were seen from there, as by a camera or in a room: rays from the origin meet the surface
            once, and the points are spread over directions as a scanner spreads them. Else up if
            the points are a height field, as of a terrain: few of them are on a wall, or have
            another sheet of the surface above or below them. Else outward.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (points, 3) float64, of unit length. Zero for points that represent no surface: with a value
        that is not finite, above 1e150, or above 1e30 where most points have smaller ones; and many
        points at one position, such as 0, 0, 0. All are zero if fewer than three points are left,
        or all coincide.

    Raises:
        ValueError: A shape or type is wrong, there are no points, `neighbours` is out of range, a
            viewpoint is not finite, or the direction is unknown.
        Cancelled: `progress` returned False.
    """
    rows = as_floats("points", points, ("points", 3), np.float64)
    viewpoints = as_viewpoints(viewpoint)
    side = as_name("direction", direction)
    used = as_threads(threads)
    rows = mask_unseen(rows, progress_part(progress, 0.0, 0.05), used)
    if side == "auto":
        side = "outward"
        if len(viewpoints) == 0:
            side, _ = guess_direction(rows, progress_part(progress, 0.05, 0.1), used)
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


def guess_direction(
    points: npt.NDArray[np.float64], progress: ProgressCallback | None, threads: int
) -> tuple[str, str]:
    """Guesses a direction for normals from the points alone.

    Returns:
        The direction: "viewpoint" (the origin), "up" or "outward". The role of the origin:
        "scanner", "either" (a scanner in a room, or the center of an object) or "none".
    """
    origin = _native.origin_role(points, as_progress(progress_part(progress, 0.0, 0.7)), threads)
    if origin == "scanner":
        return "viewpoint", origin
    progress = as_progress(progress_part(progress, 0.7, 1.0))
    return "up" if _native.is_height_field(points, progress) else "outward", origin


def mask_unseen(
    points: npt.NDArray[np.float64], progress: ProgressCallback | None, threads: int
) -> npt.NDArray[np.float64]:
    """Replaces points that represent no surface by NaN.

    These have huge coordinates while most points do not, or share one position with many others.
    """
    finite = np.isfinite(points).all(axis=1)
    huge = finite & (np.abs(points) >= _HUGE).any(axis=1)
    others = np.count_nonzero(finite & ~huge)
    unseen = np.zeros(len(points), bool)
    if np.count_nonzero(huge) <= _MAX_HUGE_PER_OTHER * others:
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
    """Normals of points connected by triangles: area-weighted means of the triangles' normals.

    Args:
        points: (points, 3).
        triangles: (triangles, 3) integer indices of points, counter-clockwise seen from outside.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        (points, 3) float64, of unit length; zero for points without a triangle that has a normal.

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
    """Normals of points in a scanner's grid, from the triangles between neighbors.

    Triangles with an edge over four times as long as usual would join a surface to another one
    behind it, and are left out.

    Args:
        points: (points, 3), in the coordinates of the scanner, before any alignment.
        grid: (rows, columns) integer indices of points, -1 for none; `read_range_grid` reads them.
        viewpoint: Position of the scanner, (3,): the side that shows more to it is outside. None:
            far away at large z, as for the scanners of Stanford's range scans.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        Normals, (points, 3) float64, of unit length, zero for points without neighbors; and
        weights, (points,) float32 in [0, 1], lower where the surface was seen at an angle and
        within six grid cells of its border.

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
    array = as_array("viewpoint", viewpoint)
    if array.ndim == 1:
        return as_floats("viewpoint", array, (3,), np.float64).reshape(1, 3)
    rows = as_floats("viewpoint", array, ("points", 3), np.float64)
    if len(rows) == 0:
        raise ValueError("viewpoint: shape (0, 3); one for all points or one for each is needed")
    return rows
