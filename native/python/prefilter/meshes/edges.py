# SPDX-License-Identifier: GPL-3.0-or-later

"""The edges of meshes."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_progress
from .._border.arrays import as_mesh, as_threads


class MeshEdges(NamedTuple):
    """The edges of a mesh, numbered.

    Attributes:
        vertices: (edges, 2) int32: each edge once, from its vertex with the lower number to the
            other, in ascending order.
        corners: (triangles, 3) int32: the edge from each corner to the next one; -1 if both are the
            same vertex.
    """

    vertices: npt.NDArray[np.int32]
    corners: npt.NDArray[np.int32]


def mesh_edges(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> MeshEdges:
    """The edges of a mesh, and the edge that starts at each corner of a triangle.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, a
            value is not finite, or there are more than 715827882 triangles.
        Cancelled: `progress` returned False.
    """
    edges = _native.mesh_edges(
        *as_mesh(positions, triangles), as_progress(progress), as_threads(threads)
    )
    return MeshEdges(*edges)
