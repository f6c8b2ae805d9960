# SPDX-License-Identifier: GPL-3.0-or-later

"""The parts of meshes, and their handles."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_progress
from .._border.arrays import as_mesh, as_threads


@dataclass(frozen=True)
class MeshTopology:
    """How a mesh hangs together.

    Attributes:
        parts: How many there are: triangles that hang together by edges.
        cavities: How many parts bound one: closed, with faces that agree on a side, and inside out.
        borders: Loops of edges with a single triangle.
        genus: The handles of all parts together: 0 for spheres and discs, 1 for a ring. None if
            more than two triangles share an edge, or a surface has one side.
        border_edges: (edges, 2) int32: the edges with a single triangle, each from its vertex with
            the lower number, in ascending order.
        part_of: (triangles,) int32: the part of each, numbered in order of their first triangles;
            -1 for a triangle of which two corners are one vertex.
    """

    parts: int
    cavities: int
    borders: int
    genus: int | None
    border_edges: npt.NDArray[np.int32]
    part_of: npt.NDArray[np.int32]

    @property
    def solids(self) -> int:
        """How many parts there are without cavities: what hangs together as a solid."""
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

    Parts that meet at a vertex alone are several, each with its own surface around it.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        weld: Whether vertices of borders count as one where they are at one place.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, a
            value is not finite, or there are more than 715827882 triangles.
        Cancelled: `progress` returned False.
    """
    found = _native.mesh_topology(
        *as_mesh(positions, triangles), weld, as_progress(progress), as_threads(threads)
    )
    return MeshTopology(*found)
