# SPDX-License-Identifier: GPL-3.0-or-later

"""Meshes made ready for voxelizing: their holes closed."""

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
        positions: (vertices, 3) float64: the mesh's own, and those of the caps; or what was passed
            if there are no caps.
        triangles: (triangles, 3) int64: the mesh's own first; likewise.
        open_edges: Unbalanced edges of the mesh: traversed more often in one direction.
        holes: Loops of such edges.
        left_open: Of these loops, those without a cap, which would cancel the surface.
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

    `voxelize` takes open meshes, and what a hole does stays close to it; but there, the surface
    ends in steps. With caps, every edge is traversed as often one way as the other, so winding
    numbers are whole. Vertices at one place count as one. Faces that are turned against their
    neighbors are made up for, too.

    A hole stays open where its cap would cancel the surface: around a sheet, whose cap would be the
    sheet turned over; between pieces that are close to each other and together enclose something;
    and where the cap is inside out.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices, counter-clockwise from outside.
        method: "smooth" continues the surface: a patch with triangles as large as the edges around
            it that leaves the border in the surface's plane and bends as little as possible. Where
            surface and cap meet at more than 75 degrees, as at the end of a tube, the border is
            kept as a crease. Holes of up to 6 edges get a fan. "flat" takes the triangles of
            the smallest area between the vertices of the border. "fan" joins the border to its
            middle.
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
