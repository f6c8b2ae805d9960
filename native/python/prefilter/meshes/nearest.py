# SPDX-License-Identifier: GPL-3.0-or-later

"""Nearest points on a mesh."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_progress
from .._border.arrays import as_floats, as_labels, as_mesh, as_threads

Found: TypeAlias = tuple[npt.NDArray[np.int64], npt.NDArray[np.float64], npt.NDArray[np.float64]]


class NearestPoints:
    """A mesh prepared for repeated searches.

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
        """Finds the nearest points on the mesh; see `nearest_points`.

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
    """Nearest points on a mesh, to transfer attributes from one surface to another.

    `NearestPoints` does the same for repeated searches.

    Args:
        points: (points, 3).
        positions: (vertices, 3).
        triangles: (triangles, 3) integer indices of vertices; zero area is allowed.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        For each point the index of the triangle, (points,) int64; the weights of its corners at the
        nearest point, (points, 3) float64, which sum to 1; and the distance, (points,) float64.
        Among triangles at the same distance, the one with the lowest index is returned.

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


@dataclass(frozen=True)
class CornerPoints:
    """Points on a mesh, and the assignment of a surface's corners to them.

    Attributes:
        triangles: (points,) int64, the triangle of each point. The first points belong to the
            surface's vertices, one each.
        weights: (points, 3) float64: weights of the triangle's corners; they sum to 1.
        corners: (surface triangles, 3) int32, indices of points.
    """

    triangles: npt.NDArray[np.int64]
    weights: npt.NDArray[np.float64]
    corners: npt.NDArray[np.int32]


def corner_points(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    origins: npt.ArrayLike,
    source_positions: npt.ArrayLike,
    source_triangles: npt.ArrayLike,
    labels: npt.ArrayLike,
    *,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> CornerPoints:
    """Points on a source mesh that correspond to the corners of a surface made from it.

    Each corner gets the nearest point on the source triangles with the same label as the triangle
    that the corner's triangle came from: with a label for each chart of a UV map, no triangle gets
    UVs of two charts. A vertex between triangles of several labels has a point for each.

    Args:
        positions: (vertices, 3) of the surface.
        triangles: (triangles, 3) of the surface.
        origins: (triangles,) integers: the source triangle that each came from.
        source_positions: (source vertices, 3).
        source_triangles: (source triangles, 3).
        labels: (source triangles,) integers.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex or
            triangle, or a value is not finite or above 1e150.
        Cancelled: `progress` returned False.
    """
    surface = as_mesh(positions, triangles)
    source = as_mesh(
        source_positions, source_triangles, names=("source_positions", "source_triangles")
    )
    (nearest, weights, _), corners = _native.corner_points(
        *surface,
        as_labels("origins", origins, len(surface[1]), "triangles"),
        *source,
        as_labels("labels", labels, len(source[1]), "source triangles"),
        as_progress(progress),
        as_threads(threads),
    )
    return CornerPoints(nearest, weights, corners)
