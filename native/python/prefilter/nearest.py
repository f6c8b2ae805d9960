"""The points of a mesh nearest to others."""

import numpy as np
import numpy.typing as npt

from . import _native
from ._border.arguments import ProgressCallback, as_progress
from ._border.arrays import as_floats, as_mesh, as_threads

Found = tuple[npt.NDArray[np.int64], npt.NDArray[np.float64], npt.NDArray[np.float64]]


class NearestPoints:
    """A mesh made ready for searches, for one that is asked several times.

    Args:
        positions: (vertices, 3).
        triangles: (triangles, 3) integer indices of vertices; zero area is allowed.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, or a
            value is not finite or above 1e150.
        Cancelled: `progress` returned False.
    """

    def __init__(
        self,
        positions: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        progress: ProgressCallback | None = None,
        threads: int = 0,
    ) -> None:
        self._tree = _native.NearestPoints(
            *as_mesh(positions, triangles),
            as_progress(progress),
            as_threads(threads),
        )

    def find(
        self, points: npt.ArrayLike, *, progress: ProgressCallback | None = None, threads: int = 0
    ) -> Found:
        """Where the mesh is nearest to points; see `nearest_points`.

        Args:
            points: (points, 3).
            progress: Called with the fraction done; returning False stops the work.
            threads: 0 means all processors. The result does not depend on it.

        Raises:
            ValueError: A shape or type is wrong, or a value is not finite or above 1e150.
            Cancelled: `progress` returned False.
        """
        return self._tree.find(
            as_floats("points", points, ("points", 3), np.float64),
            as_progress(progress),
            as_threads(threads),
        )


def nearest_points(
    points: npt.ArrayLike,
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> Found:
    """Where a mesh is nearest to points: what attributes are carried from surface to surface by.

    `NearestPoints` does the same for a mesh that is asked several times.

    Args:
        points: (points, 3).
        positions: (vertices, 3).
        triangles: (triangles, 3) integer indices of vertices; zero area is allowed.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        For each point the index of the triangle, (points,) int64; the weights of its corners at the
        nearest point, (points, 3) float64, which sum to 1; and the distance, (points,) float64. Of
        several triangles at the same distance it is the one with the lowest index.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, or a
            value is not finite or above 1e150.
        Cancelled: `progress` returned False.
    """
    return _native.nearest_points(
        as_floats("points", points, ("points", 3), np.float64),
        *as_mesh(positions, triangles),
        as_progress(progress),
        as_threads(threads),
    )
