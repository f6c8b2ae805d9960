# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures and self-intersections of meshes."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_progress
from .._border.arrays import as_mesh, as_threads


@dataclass(frozen=True)
class MeshMeasures:
    """Size of a mesh.

    Attributes:
        box: (low corner, high corner) of the triangles; unused vertices do not count.
        area: Total area of the triangles.
        volume: The enclosed volume; negative if the mesh is inside out. For an open mesh, relative
            to one of its corners.
    """

    box: tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]
    area: float
    volume: float


def measure_mesh(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> MeshMeasures:
    """The box, the area and the volume of a mesh, in one pass.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices, counter-clockwise from outside.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, or a
            value is not finite.
        Cancelled: `progress` returned False.
    """
    (low, high), area, volume = _native.measure_mesh(
        *as_mesh(positions, triangles), as_progress(progress), as_threads(threads)
    )
    return MeshMeasures((np.array(low), np.array(high)), area, volume)


def self_intersections(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.int64]:
    """Pairs of triangles that intersect beyond the vertices and edges that they share by index.

    These are pairs that cross, overlap or touch, by exact predicates. Triangles of zero area are
    ignored.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (pairs, 2) indices of triangles, the lower one first, in order.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, or a
            value is not finite.
        Cancelled: `progress` returned False.
    """
    return _native.self_intersections(
        *as_mesh(positions, triangles), as_progress(progress), as_threads(threads)
    )
