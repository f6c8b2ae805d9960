"""Meshes made ready for voxelizing: their holes closed."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from . import _native
from ._border.arguments import ProgressCallback, as_progress
from ._border.arrays import as_mesh


@dataclass(frozen=True)
class ClosedMesh:
    """A mesh and the caps of its holes.

    Attributes:
        positions: (vertices, 3) float64: the mesh's own, and those of the caps.
        triangles: (triangles, 3) int64: the mesh's own first.
        open_edges: Unbalanced edges of the mesh: traversed more often in one direction.
        holes: Loops of such edges.
    """

    positions: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int64]
    open_edges: int
    holes: int


def close_holes(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    progress: ProgressCallback | None = None,
) -> ClosedMesh:
    """The mesh with a fan of triangles over each of its holes, for `voxelize`.

    `voxelize` takes open meshes, and what a hole does stays close to it; but there, the surface
    ends in steps. With caps, every edge is run through as often one way as the other, so winding
    numbers are whole, and a hole is closed by a cone to the middle of its border. Vertices at one
    place count as one. Faces that are turned against their neighbours are made up for, too.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices, counter-clockwise from outside.
        progress: Called with the fraction done; returning False stops the work.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, or a
            value is not finite.
        Cancelled: `progress` returned False.
    """
    return ClosedMesh(
        *_native.close_holes(
            *as_mesh(positions, triangles),
            as_progress(progress),
        )
    )
