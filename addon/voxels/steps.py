"""What voxelizing and combining have in common: meshes to cells, and cells to a surface."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge import solids
from ..bridge.files.staging import StagedFile
from ..bridge.new_meshes import Contour
from ..bridge.place import Place
from ..bridge.units import length, volume
from ..core.jobs import Progress, share
from ..core.wording import amount
from .choices import VoxelSettings
from .grid import Box, Grid, cells_crossed, choose_grid
from .solid_meshes import SolidMesh

# What a load takes in seconds, as measured once on two cores; ratios are what counts.
_ALWAYS = 0.01
_PER_TRIANGLE = 1e-6
_VOXELIZING = 0.5e-6
_CONTOURING = {"plane": 4e-6, "occupancy": 2e-6, "linear": 2e-6}
_CLEANING = 12e-6
_TRANSFERRING = 3e-6
_WRITING = 1e-8
VOXELIZED, _CONTOURED = 0.5, 0.75
"""What the progress is once the tree is made, and once there is a surface."""


@dataclass(frozen=True)
class Result:
    """A surface, or a staged file of a volume, and numbers about it."""

    place: Place
    grid: Grid
    volume: float
    triangles: int
    contour: Contour | None = None
    staged: StagedFile | None = None


@dataclass(frozen=True)
class Load:
    """What decides how long meshes in one grid take.

    Attributes:
        box: What the grid is around.
        area: The area of the triangles.
        triangles: How many there are.
        transfers: Whether the result gets materials or colours of the nearest points.
    """

    box: Box
    area: float
    triangles: int
    transfers: bool

    @classmethod
    def of(cls, box: Box, meshes: Sequence[SolidMesh]) -> "Load":
        """Returns the load of meshes in a box."""
        return cls(
            box,
            sum(mesh.area for mesh in meshes),
            sum(len(mesh.triangles) for mesh in meshes),
            any(mesh.colors or mesh.has_several_materials() for mesh in meshes),
        )

    def seconds(self, settings: VoxelSettings) -> float:
        """Returns about how long it takes on two cores; settings that are refused take none."""
        try:
            grid = choose_grid(self.box, settings)
        except ValueError:
            return 0.0
        crossed = cells_crossed(grid, self.area)
        seconds = _ALWAYS + _PER_TRIANGLE * self.triangles + _VOXELIZING * crossed
        if getattr(settings, "output", "mesh") == "volume":
            return seconds + _WRITING * float(grid.cells) ** 3
        per_cell = _CONTOURING[settings.interpolant]
        if settings.use_cleanup:
            per_cell += _CLEANING
        if self.transfers and (settings.use_materials or settings.use_colors):
            per_cell += _TRANSFERRING
        return seconds + per_cell * crossed


def voxelized(
    mesh: SolidMesh, grid: Grid, settings: VoxelSettings, progress: Progress
) -> "prefilter.Octree":
    """Returns the occupancy of a mesh, its holes closed if that is asked for."""
    positions = mesh.positions
    triangles: NDArray[np.integer[Any]] = mesh.triangles
    if settings.use_close_holes and mesh.open_edges:
        closed = prefilter.close_holes(positions, triangles, progress=share(progress, 0.0, 0.3))
        positions, triangles = closed.positions, closed.triangles
    return prefilter.voxelize(
        positions,
        triangles,
        depth=grid.depth,
        bounds=grid.bounds,
        progress=share(progress, 0.3, 1.0),
        threads=settings.threads,
    )


def contoured(
    tree: "prefilter.Octree",
    grid: Grid,
    mesh: SolidMesh,
    solid: solids.Solid,
    place: Place,
    settings: VoxelSettings,
    progress: Progress,
) -> Result:
    """Returns the surface of a tree, with what it gets from the mesh.

    Raises:
        ValueError: There is no surface.
    """
    middle = (_CONTOURED - VOXELIZED) / (1.0 - VOXELIZED)
    positions, triangles = tree.contour(
        interpolant=settings.interpolant,
        cleanup=settings.use_cleanup,
        progress=share(progress, 0.0, middle),
        threads=settings.threads,
    )
    if len(triangles) == 0:
        raise ValueError(
            "the result is empty: no cell is at least half full. Parts that are thinner than a "
            "cell, or enclose nothing, have no voxels"
        )
    face_materials, colors = _transferred(
        mesh, positions, triangles, settings, share(progress, middle, 1.0)
    )
    local, turned = place.localize(positions, triangles)
    contour = Contour(
        local,
        turned,
        solid.materials if settings.use_materials else (),
        face_materials,
        colors,
        solid.active_color,
        solid.render_color,
        settings.smooth_angle if settings.use_smooth else None,
    )
    return Result(place, grid, tree.volume, len(triangles), contour)


def _transferred(
    mesh: SolidMesh,
    positions: NDArray[np.float64],
    triangles: NDArray[np.int32],
    settings: VoxelSettings,
    progress: Progress,
) -> tuple[NDArray[np.int32] | None, dict[str, tuple[str, NDArray[np.float32]]]]:
    """Returns the materials of triangles and the colours of vertices, from the nearest surface."""
    with_materials = settings.use_materials and mesh.has_several_materials()
    with_colors = settings.use_colors and bool(mesh.colors)
    face_materials = None
    if settings.use_materials and len(mesh.materials):
        face_materials = np.full(len(triangles), mesh.materials[0], np.int32)
    colors: dict[str, tuple[str, NDArray[np.float32]]] = {}
    if not with_materials and not with_colors:
        return face_materials, colors
    # One call for both, as each prepares the mesh anew.
    points = [
        *([positions[triangles].mean(axis=1)] if with_materials else []),
        *([positions] if with_colors else []),
    ]
    nearest, weights, _ = prefilter.nearest_points(
        np.concatenate(points),
        mesh.positions,
        mesh.triangles,
        progress=progress,
        threads=settings.threads,
    )
    if with_materials:
        face_materials = mesh.materials[nearest[: len(triangles)]]
    if with_colors:
        nearest, weights = nearest[-len(positions) :], weights[-len(positions) :]
        for name, color in mesh.colors.items():
            corners = color.values[color.corners[nearest]]
            blended = np.einsum("ij,ijk->ik", weights, corners).astype(np.float32)
            colors[name] = (color.data_type, blended)
    return face_materials, colors


def tell_defects(name: str, mesh: SolidMesh, warnings: list[str], notes: list[str]) -> None:
    """Adds what is odd about a mesh to warnings and notes."""
    if mesh.flipped:
        warnings.append(f"object '{name}' was inside out; its normals were flipped")
    if mesh.open_edges:
        edges = "1 open edge" if mesh.open_edges == 1 else f"{mesh.open_edges} open edges"
        notes.append(f"object '{name}' has {edges}; the result is closed")


def told(result: Result) -> str:
    """Returns numbers about a result, in words."""
    cells = f"'{result.place.name}' in {result.grid.cells}³ cells of {length(result.grid.spacing)}"
    triangles = f"{amount(result.triangles, 'triangle')}, " if result.contour is not None else ""
    return f"{cells}: {triangles}volume {volume(result.volume)}"
