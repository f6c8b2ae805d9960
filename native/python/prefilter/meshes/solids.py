# SPDX-License-Identifier: GPL-3.0-or-later

"""Making solids of arbitrary meshes."""

from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    as_name,
    as_number,
    as_progress,
    set_options,
)
from .._border.arrays import as_mesh, as_threads

_CHECKS: dict[str, Check] = {
    "cell": partial(as_number, "cell"),
    "weld": partial(as_number, "weld"),
    "gap": partial(as_number, "gap"),
    "thickness": partial(as_number, "thickness"),
    "sheets": partial(as_name, "sheets"),
    "threads": as_threads,
}


@dataclass(frozen=True)
class SolidMesh:
    """A mesh suitable for `voxelize`, with statistics of the repairs.

    Attributes:
        positions: (vertices, 3) float64, or the argument itself if the mesh is unchanged.
        triangles: (triangles, 3) int64, or the argument itself if the mesh is unchanged.
        origins: (triangles,) int64: the input triangle that each came from, or -1 for those that
            bound regions unreachable from outside. None if the mesh is unchanged.
        parts: Patches of the mesh: faces connected by edges of exactly two faces.
        welded_vertices: Vertices that were merged into others.
        duplicate_faces: Duplicates of faces that were dropped.
        turned_faces: Faces that were flipped to agree with others of their part.
        turned_parts: Parts that were flipped as a whole.
        thickened_parts: Sheets and parts that were too thin for any cell.
        filled_parts: Parts whose inside is the region that the outside does not reach.
        turned: (n,) int64: the input triangles that were flipped.
    """

    positions: npt.NDArray[np.floating]
    triangles: npt.NDArray[np.integer]
    origins: npt.NDArray[np.int64] | None
    parts: int
    welded_vertices: int
    duplicate_faces: int
    turned_faces: int
    turned_parts: int
    thickened_parts: int
    filled_parts: int
    turned: npt.NDArray[np.int64]

    @property
    def is_unchanged(self) -> bool:
        """Whether the mesh is unchanged."""
        return self.origins is None


def as_solid(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    cell: float,
    weld: float = 0.05,
    gap: float = 2.0,
    thickness: float = 1.5,
    sheets: str = "shell",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> SolidMesh:
    """A mesh suitable for `voxelize`, from arbitrary triangles.

    A mesh that is closed, consistently oriented and not too thin is unchanged. In others, close
    vertices along open edges are welded, duplicate faces dropped, faces flipped to agree with their
    neighbors, and parts oriented so that their outside faces outward. Where the orientation
    encloses nothing, the inside is the region that the outside does not reach. Sheets and thin
    parts get a thickness.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        cell: The side of the cells for voxelization, in the mesh's unit.
        weld: Cells: vertices along open edges are merged up to this distance. 0 merges only
            vertices at the same position.
        gap: Cells: the outside does not reach through gaps up to this width.
        thickness: Cells: thickness given to sheets and thin parts. 0 leaves them unchanged.
        sheets: How sheets get it: "shell", by prisms on both sides, or "faces", by duplicating
            faces in opposite orientation, for a `voxelize` with this `thickness`.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, a
            value is not finite, `cell` is not above 0, or another length is negative.
        MemoryError: The work would not fit into memory.
        Cancelled: `progress` returned False.
    """
    options = set_options(_native.SolidOptions(), _CHECKS, locals())
    points, indices = as_mesh(positions, triangles)
    mesh, report = _native.as_solid(points, indices, options, as_progress(progress))
    vertices, corners, origins = mesh or (points, indices, None)
    turned = np.empty(0, np.int64)
    if origins is not None and report[3] + report[4]:
        turned = _turned(points[indices], vertices[corners], origins)
    return SolidMesh(vertices, corners, origins, *report, turned)


def _turned(
    before: npt.NDArray[np.floating],
    after: npt.NDArray[np.floating],
    origins: npt.NDArray[np.int64],
) -> npt.NDArray[np.int64]:
    """Returns the triangles whose successors are all flipped."""
    ways = np.zeros((2, len(before)), bool)
    known = origins >= 0
    own = (_normals(before)[origins[known]] * _normals(after[known])).sum(axis=1)
    ways[0, origins[known][own > 0.0]] = True
    ways[1, origins[known][own < 0.0]] = True
    return np.flatnonzero(ways[1] & ~ways[0])


def _normals(corners: npt.NDArray[np.floating]) -> npt.NDArray[np.float64]:
    a, b, c = np.moveaxis(corners.astype(np.float64), 1, 0)
    return np.cross(b - a, c - a)
