# SPDX-License-Identifier: GPL-3.0-or-later

"""Connected parts and genus of meshes."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_progress
from .._border.arrays import as_mesh, as_threads


@dataclass(frozen=True)
class MeshTopology:
    """Connectivity of a mesh.

    Attributes:
        parts: Number of parts: triangles connected by edges.
        cavities: Number of parts that bound a cavity: closed, consistently oriented, and inside
            out.
        borders: Number of loops of edges with a single triangle.
        genus: Number of handles of all parts together: 0 for spheres and discs, 1 for a ring. None
            if more than two triangles share an edge, or a surface has one side.
        border_edges: (edges, 2) int32: the edges with a single triangle, each from its vertex with
            the lower number, in ascending order.
        part_of: (triangles,) int32: the part of each, numbered in order of their first triangles;
            -1 for a triangle with two equal vertices.
    """

    parts: int
    cavities: int
    borders: int
    genus: int | None
    border_edges: npt.NDArray[np.int32]
    part_of: npt.NDArray[np.int32]

    @property
    def solids(self) -> int:
        """Number of parts that are not cavities: connected solids."""
        return self.parts - self.cavities


def mesh_topology(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    weld: bool = True,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> MeshTopology:
    """The parts of a mesh, its genus and its borders.

    Parts that meet only at a vertex are separate, and each has its own surface around it.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        weld: Whether border vertices at the same position count as one.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, a
            value is not finite, or there are more than 715827882 triangles.
        Cancelled: `progress` returned False.
    """
    topology = _native.mesh_topology(
        *as_mesh(positions, triangles), weld, as_progress(progress), as_threads(threads)
    )
    return MeshTopology(*topology)
