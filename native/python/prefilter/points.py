"""Points of a surface, as scanners give them."""

import numpy as np
import numpy.typing as npt

from . import _native
from ._border.arguments import ProgressCallback, as_int, as_progress
from ._border.arrays import as_array, as_floats, as_threads


def estimate_normals(
    points: npt.ArrayLike,
    *,
    neighbours: int = 16,
    viewpoint: npt.ArrayLike | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float64]:
    """The normals of points on a surface, from the planes that fit the points around each best.

    Args:
        points: (points, 3).
        neighbours: How many points around each (itself included) the plane is fitted to, 3 to 1000.
            More are better for noisy points, fewer for fine detail. Copies of a point count once.
        viewpoint: Where the scanner stood, (3,), or one place for each point, (points, 3): normals
            point to it. Without, they agree with those around them, and those of each connected
            part point outward as a whole, as those of a closed surface do.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (points, 3) float64, 1 long. They are zero for points that hold a value that is not finite
        or above 1e150, and for all where fewer than three points are left or all coincide.

    Raises:
        ValueError: A shape or type is wrong, there are no points, `neighbours` is out of range, or
            a viewpoint is not finite.
        Cancelled: `progress` returned False.
    """
    return _native.estimate_normals(
        as_floats("points", points, ("points", 3), np.float64),
        as_int("neighbours", neighbours, "a whole number from 3 to 1000 is needed"),
        _as_viewpoints(viewpoint),
        as_progress(progress),
        as_threads(threads),
    )


def _as_viewpoints(viewpoint: npt.ArrayLike | None) -> npt.NDArray[np.float64]:
    if viewpoint is None:
        return np.empty((0, 3))
    found = as_array("viewpoint", viewpoint)
    if found.ndim == 1:
        return as_floats("viewpoint", found, (3,), np.float64).reshape(1, 3)
    rows = as_floats("viewpoint", found, ("points", 3), np.float64)
    if len(rows) == 0:
        raise ValueError("viewpoint: shape (0, 3); one for all points or one for each is needed")
    return rows
