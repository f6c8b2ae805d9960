# SPDX-License-Identifier: GPL-3.0-or-later

"""Closing the holes of meshes for voxelization."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_name, as_progress
from .._border.arrays import as_mesh, as_threads


@dataclass(frozen=True)
class ClosedMesh:
    """A mesh and the caps of its holes.

    Attributes:
        positions: (vertices, 3) float64: the mesh's own, then those of the caps; or the argument
            itself if there are no caps.
        triangles: (triangles, 3) int64: the mesh's own, then the caps; or the argument itself.
        open_edges: Number of unbalanced edges, traversed more often in one direction.
        holes: Number of loops of such edges.
        left_open: Number of loops without a cap, because it would cancel the surface.
    """

    positions: npt.NDArray[np.floating]
    triangles: npt.NDArray[np.integer]
    open_edges: int
    holes: int
    left_open: int


def close_holes(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    method: str = "smooth",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> ClosedMesh:
    """The mesh with its holes closed, for `voxelize`.

    `voxelize` takes open meshes, and a hole affects only its vicinity; but there, the surface ends
    in steps. With caps, every edge is traversed equally often in both directions, so winding
    numbers are integers. Vertices at the same position count as one. Caps also compensate for faces
    that are oriented against their neighbors.

    A hole stays open if its cap would cancel the surface: around a sheet, whose cap would be the
    sheet itself with opposite orientation; between close pieces that together enclose a volume; and
    if the cap is inside out.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices, counter-clockwise from outside.
        method: "smooth" continues the surface: a patch, with triangles of the size of the
            surrounding edges, that leaves the border in the surface's plane and bends as little as
            possible. Where surface and cap meet at more than 75 degrees, as at the end of a tube,
            the border stays a crease. Holes of up to 6 edges get a fan. "flat" takes the triangles
            of the smallest area between the vertices of the border. "fan" joins the border to its
            center.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, a
            value is not finite, or `method` is unknown.
        Cancelled: `progress` returned False.
    """
    return ClosedMesh(
        *_native.close_holes(
            *as_mesh(positions, triangles),
            as_name("method", method),
            as_progress(progress),
            as_threads(threads),
        )
    )
