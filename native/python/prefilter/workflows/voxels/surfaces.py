# SPDX-License-Identifier: GPL-3.0-or-later

"""From any mesh to the occupancy of cells, and from occupancy to a surface."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import prefilter

from ...options.voxels import VoxelSettings
from ..progress import Progress, share
from ..wording import Sentence, counted, joined
from .grid import Grid

_FILLED = Sentence("parts filled where the outside does not reach: {}")
_TURNED = Sentence("faces flipped to agree with their neighbors: {}")
_WELDED = Sentence("vertices welded: {}")
_DUPLICATE = Sentence("duplicate faces dropped: {}")


@dataclass(frozen=True)
class Occupancy:
    """The occupancy of cells by a mesh, and the solid that the mesh was turned into.

    Attributes:
        tree: The occupancy.
        solid: The mesh as a solid.
        positions: (n, 3) vertices of the solid with its holes closed.
        triangles: (m, 3) triangles of the same.
        origins: (m,) the triangle of the input mesh that each came from, or -1; None if they are
            unchanged.
        holes: Number of holes that were closed.
        open_edges: Number of open edges before that.
    """

    tree: prefilter.Octree
    solid: prefilter.SolidMesh
    positions: NDArray[Any]
    triangles: NDArray[np.integer]
    origins: NDArray[np.int64] | None
    holes: int
    open_edges: int


def occupancy(
    positions: NDArray[Any],
    triangles: NDArray[np.integer],
    grid: Grid,
    settings: VoxelSettings,
    progress: Progress,
) -> Occupancy:
    """Makes a mesh solid and voxelizes it.

    Raises:
        ValueError: The mesh encloses nothing.
        MemoryError: The tree does not fit into memory.
        prefilter.Cancelled: `progress` returned False.
    """
    solid = prefilter.as_solid(
        positions,
        triangles,
        cell=grid.spacing,
        gap=settings.gap,
        thickness=settings.thickness,
        sheets="faces",
        progress=share(progress, 0.0, 0.2),
        threads=settings.threads,
    )
    positions, triangles, origins = solid.positions, solid.triangles, solid.origins
    closed = prefilter.close_holes(
        positions,
        triangles,
        method=settings.holes,
        progress=share(progress, 0.2, 0.3),
        threads=settings.threads,
    )
    added = len(closed.triangles) - len(triangles)
    if settings.use_close_holes and added:
        own = np.arange(len(triangles)) if origins is None else origins
        origins = np.concatenate([own, np.full(added, -1, np.int64)])
        positions, triangles = closed.positions, closed.triangles
    tree = prefilter.voxelize(
        positions,
        triangles,
        depth=grid.depth,
        bounds=grid.bounds,
        thickness=settings.thickness,
        progress=share(progress, 0.3, 1.0),
        threads=settings.threads,
    )
    holes = closed.holes - closed.left_open if settings.use_close_holes else 0
    return Occupancy(tree, solid, positions, triangles, origins, holes, closed.open_edges)


def surface(
    tree: prefilter.Octree,
    meshes: Sequence[tuple[Any, ...]],
    settings: VoxelSettings,
    progress: Progress,
    *,
    adaptivity: float,
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int64] | None]:
    """Returns a surface, and the source triangles that its faces come from, if known.

    Args:
        tree: The occupancy.
        meshes: The sources, as `Octree.contour` takes them.
        settings: The settings of the surface.
        progress: Called with the fraction done.
        adaptivity: Replaces that of the settings.
    """
    if settings.faces == "quads":
        quads = tree.quad_contour(
            interpolant=settings.interpolant,
            sources=meshes if settings.interpolant == "sharp" else None,
            progress=progress,
            threads=settings.threads,
        )
        return quads.positions, quads.quads, quads.origins
    if settings.interpolant != "sharp":
        contour = tree.contour(
            interpolant=settings.interpolant,
            adaptivity=adaptivity,
            cleanup=settings.use_cleanup,
            progress=progress,
            threads=settings.threads,
        )
        return (*contour, None)
    traced = tree.traced_contour(
        meshes,
        adaptivity=adaptivity,
        cleanup=settings.use_cleanup,
        progress=progress,
        threads=settings.threads,
    )
    return traced.positions, traced.triangles, traced.origins


def repair_lines(name: str, occupancy: Occupancy) -> tuple[list[str], list[str]]:
    """Returns warnings and notes about repairs to an object's mesh."""
    warnings: list[str] = []
    notes: list[str] = []
    solid = occupancy.solid
    turned = solid.turned_parts
    if turned and turned >= solid.parts:
        text = "object '{}' was inside out; its normals were flipped"
        warnings.append(Sentence(text, name))
    elif turned:
        text = "object '{}': {} of {} parts were inside out; their normals were flipped"
        warnings.append(Sentence(text, name, turned, solid.parts))
    rows = [
        (solid.filled_parts, _FILLED),
        (solid.turned_faces, _TURNED),
        (solid.welded_vertices, _WELDED),
        (solid.duplicate_faces, _DUPLICATE),
    ]
    repairs = [Sentence(text, count) for count, text in rows if count]
    if repairs:
        notes.append(Sentence("object '{}': {}", name, joined(", ", repairs)))
    if occupancy.open_edges:
        edges = counted(range(occupancy.open_edges), "open edge")
        text = "object '{}' has {}; the result is closed"
        notes.append(Sentence(text, name, edges))
    return warnings, notes
