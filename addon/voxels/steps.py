# SPDX-License-Identifier: GPL-3.0-or-later

"""Steps shared by voxelizing and booleans: meshes to cells, and cells to a surface."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import prefilter
from numpy.typing import NDArray
from prefilter.workflows.voxels import surfaces
from prefilter.workflows.voxels.empty_results import NO_FILLED_CELL, NothingLeftError

from ..bridge import solids
from ..bridge.files.staging import StagedFile
from ..bridge.layers import COLOR, NORMALS, LayerSelection, NewLayer
from ..bridge.new_meshes import Contour
from ..bridge.target_frame import TargetFrame
from ..bridge.units import length, volume
from ..core.jobs import Progress, go_on, share
from ..core.translations import marked
from ..core.wording import Sentence, amount, listed
from .choices import VoxelSettings
from .edge_marks import carried_marks
from .findings import Findings, Report, Walls, advice_on, find, line, walls_in
from .grid import Box, Grid, cells_crossed, choose_grid
from .quads import face_edges, halves
from .shading import sharp_angle, weighted_normals
from .solid_meshes import SolidMesh, solid_mesh
from .transfer import Source, Transfer, find_groups, find_labels, groups_of

# Seconds, measured once on two cores; only their ratios matter.
_CONSTANT = 0.01
_PER_TRIANGLE = 1e-6
_VOXELIZING = 0.5e-6
_CONTOURING = {"sharp": 6e-6, "plane": 4e-6, "occupancy": 2e-6, "linear": 2e-6}
_QUADS = 4e-6
_CLEANING = 12e-6
_TRANSFERRING = 3e-6
_WRITING = 1e-8
VOXELIZED, _CONTOURED = 0.5, 0.75
"""Progress after the tree is made, and after the surface is made."""


@dataclass(frozen=True)
class Result:
    """A surface, or a staged volume file, and numbers about it.

    Attributes:
        frame: Target object and its space.
        grid: The cells.
        volume: Volume that the surface encloses, or that is filled.
        faces: Number of faces.
        contour: The surface; None for a volume.
        staged: The volume's file; None for a surface.
        topology: Topology of the surface.
        walls: Walls that fell apart, per source.
    """

    frame: TargetFrame
    grid: Grid
    volume: float
    faces: int
    contour: Contour | None = None
    staged: StagedFile | None = None
    topology: "prefilter.MeshTopology | None" = None
    walls: tuple[Walls | None, ...] = ()


@dataclass(frozen=True)
class Operand:
    """A mesh with its measures.

    Attributes:
        name: Name of the object.
        mesh: The mesh as read.
        measures: Measures of the mesh.
        left_out: Names of attributes that cannot be transferred.
    """

    name: str
    mesh: SolidMesh
    measures: "prefilter.MeshMeasures"
    left_out: Collection[str] = ()

    @classmethod
    def of(cls, solid: solids.Solid, settings: VoxelSettings) -> "Operand":
        """Joins the parts of a solid into one mesh."""
        mesh = solid_mesh(solid.parts)
        measures = prefilter.measure_mesh(mesh.positions, mesh.triangles, threads=settings.threads)
        return cls(solid.name, mesh, measures, solid.left_out)


@dataclass(frozen=True)
class Load:
    """Amount of work for meshes in one grid, from which its duration is estimated.

    Attributes:
        box: Box that the grid covers.
        area: Area of the triangles.
        triangles: Number of triangles.
        transfers: Whether attributes are transferred to the result.
    """

    box: Box
    area: float
    triangles: int
    transfers: bool

    @classmethod
    def of(cls, box: Box, operands: Sequence[Operand]) -> "Load":
        """Sums up the work for meshes in a box."""
        return cls(
            box,
            sum(operand.measures.area for operand in operands),
            sum(len(operand.mesh.triangles) for operand in operands),
            any(operand.mesh.layers for operand in operands),
        )

    def seconds(self, settings: VoxelSettings) -> float:
        """Estimated duration on two cores, in seconds; 0 for settings that will be refused."""
        try:
            grid = choose_grid(self.box, settings)
        except ValueError:
            return 0.0
        crossed = cells_crossed(grid, self.area)
        seconds = _CONSTANT + _PER_TRIANGLE * self.triangles + _VOXELIZING * crossed
        if getattr(settings, "output", "mesh") == "volume":
            return seconds + _WRITING * float(grid.cells) ** 3
        per_cell = _QUADS
        if settings.faces == "triangles":
            per_cell = _CONTOURING[settings.interpolant]
            if settings.use_cleanup:
                per_cell += _CLEANING
        if self.transfers:
            per_cell += _TRANSFERRING
        return seconds + per_cell * crossed


def layers_to_read(settings: VoxelSettings) -> LayerSelection:
    """Chooses the layers that the settings transfer."""
    if getattr(settings, "output", "mesh") == "volume":
        return LayerSelection(colors=False, uv_maps=False, attributes=False)
    return LayerSelection(
        colors=settings.use_colors,
        uv_maps=settings.use_uv_maps,
        attributes=settings.use_attributes,
    )


def voxelize(
    operand: Operand,
    grid: Grid,
    settings: VoxelSettings,
    messages: "Messages",
    progress: Progress,
) -> tuple["prefilter.Octree", Source]:
    """Makes a mesh a solid; returns its occupancy, and the source of the contour."""
    mesh = operand.mesh
    occupancy = surfaces.occupancy(mesh.positions, mesh.triangles, grid, settings, progress)
    positions, triangles, origins = occupancy.positions, occupancy.triangles, occupancy.origins
    messages.add_occupancy(operand.name, occupancy)
    if operand.left_out:
        messages.warnings.append(
            Sentence(_LEFT_OUT, operand.name, listed(sorted(operand.left_out)))
        )
    if _adaptivity(settings) and _has_painted_colors(mesh):
        messages.notes.append(Sentence(_SMALL, operand.name))
    tree, solid = occupancy.tree, occupancy.solid
    messages.findings.append(
        find(operand.name, mesh, solid, origins, tree, occupancy.holes, settings.threads)
    )
    if getattr(settings, "output", "mesh") == "volume":
        return tree, Source(mesh, positions, triangles, origins)
    labels = find_labels(mesh, settings.threads)
    groups = groups_of(find_groups(mesh, labels, grid.spacing), origins)
    return tree, Source(mesh, positions, triangles, origins, labels, groups)


def contour_tree(
    tree: "prefilter.Octree",
    grid: Grid,
    sources: list[Source],
    solid: solids.Solid,
    frame: TargetFrame,
    settings: VoxelSettings,
    progress: Progress,
) -> Result:
    """Extracts the surface of a tree, and transfers the sources' materials and layers to it.

    Raises:
        ValueError: There is no surface.
    """
    split = (_CONTOURED - VOXELIZED) / (1.0 - VOXELIZED)
    positions, faces, origins = _surface(tree, sources, settings, share(progress, 0.0, split))
    if len(faces) == 0:
        raise NothingLeftError(NO_FILLED_CELL)
    transfer = Transfer(sources, positions, faces, origins, grid.spacing, settings.threads)
    face_materials, layers = transfer.run(frame, share(progress, split, 1.0))
    go_on(progress, 1.0)
    local, local_faces = frame.localize(positions, faces)
    edges = face_edges(local, local_faces, settings.threads)
    contour = Contour(
        local,
        local_faces,
        solid.materials if settings.use_materials else (),
        face_materials if settings.use_materials else None,
        layers,
        solid.active,
        solid.rendered,
        sharp_angle(settings.smooth_angle) if settings.use_smooth_shading else None,
        edges,
        _shading_normals(local, local_faces, edges, layers, settings),
        carried_marks(solid.marks, positions, edges, grid.spacing, settings.threads),
        solid.locked_groups,
        solid.kept_modifiers,
    )
    triangles = halves(faces)
    topology = prefilter.mesh_topology(positions, triangles, weld=False, threads=settings.threads)
    return Result(
        frame,
        grid,
        prefilter.measure_mesh(positions, triangles, threads=settings.threads).volume,
        len(faces),
        contour,
        topology=topology,
        walls=_broken_walls(tree, topology.solids, sources, settings),
    )


def _broken_walls(
    tree: "prefilter.Octree", parts: int, sources: list[Source], settings: VoxelSettings
) -> tuple[Walls | None, ...]:
    """Thin walls of each source, if the result has more parts and no thickness was set."""
    if settings.thickness or parts == 1:
        return ()
    meshes = [(source.positions, source.triangles) for source in sources]
    before = (prefilter.mesh_topology(*mesh, threads=settings.threads).solids for mesh in meshes)
    if parts <= sum(before):
        return ()
    return tuple(walls_in(tree, *mesh, settings.threads) for mesh in meshes)


def _surface(
    tree: "prefilter.Octree", sources: list[Source], settings: VoxelSettings, progress: Progress
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int64] | None]:
    """Extracts a surface; returns the sources' triangle of each face, too, where it is known."""
    is_painted = any(_has_painted_colors(source.mesh) for source in sources)
    return surfaces.surface(
        tree,
        [source.for_contour for source in sources],
        settings,
        progress,
        adaptivity=0.0 if is_painted else settings.adaptivity,
    )


def _adaptivity(settings: VoxelSettings) -> float:
    return settings.adaptivity if settings.faces == "triangles" else 0.0


def _has_painted_colors(mesh: SolidMesh) -> bool:
    """Whether colors vary over the mesh; large triangles would lose too many of them."""
    colors = [layer.values for layer in mesh.layers if layer.kind == COLOR and len(layer.values)]
    return any(bool((values != values[0]).any()) for values in colors)


def _shading_normals(
    positions: NDArray[np.float32],
    triangles: NDArray[np.int32],
    edges: "prefilter.MeshEdges",
    layers: Sequence[NewLayer],
    settings: VoxelSettings,
) -> NDArray[np.float32] | None:
    """Normals for shading large triangles, unless the sources have custom normals."""
    is_closed = 2 * len(edges.vertices) == edges.corners.size and (edges.corners >= 0).all()
    has_normals = any(layer.kind == NORMALS for layer in layers)
    if not (_adaptivity(settings) and settings.use_smooth_shading and is_closed) or has_normals:
        return None
    return weighted_normals(positions, triangles, edges, sharp_angle(settings.smooth_angle))


_LEFT_OUT = marked("object '{}': attributes of types that cannot be kept: {}")
_SMALL = marked("object '{}' has painted colors, for which triangles stay small")


class Messages:
    """Warnings, notes and findings about meshes."""

    def __init__(self) -> None:
        """Starts empty."""
        self.warnings: list[str] = []
        self.notes: list[str] = []
        self.findings: list[Findings] = []

    def add_summary(
        self, result: Result, findings: Sequence[Findings], settings: VoxelSettings
    ) -> Report:
        """Adds a summary of the findings on an object's sources: a warning if parts are lost."""
        walls = [*(each.walls for each in findings), *result.walls]
        by_depth = settings.resolution == "depth"
        report = Report(findings, advice_on(walls, result.grid, length, by_depth=by_depth))
        summary = line(result.frame.name, report, result.topology)
        (self.warnings if any(each.lost for each in findings) else self.notes).append(summary)
        return report

    def extend(self, other: "Messages") -> None:
        """Adds other messages."""
        self.warnings += other.warnings
        self.notes += other.notes
        self.findings += other.findings

    def add_occupancy(self, name: str, occupancy: surfaces.Occupancy) -> None:
        """Adds warnings and notes on the mesh of an object."""
        warnings, notes = surfaces.repair_lines(name, occupancy)
        self.warnings += warnings
        self.notes += notes


def faces_of(settings: VoxelSettings, count: int) -> Sentence:
    """Number of faces, as text."""
    return amount(count, "quad") if settings.faces == "quads" else amount(count, "triangle")


def summarize(result: Result, settings: VoxelSettings) -> str:
    """Numbers about a result, as text."""
    size = length(result.grid.spacing)
    cells = Sentence("'{}' in {}³ cells of {}", result.frame.name, result.grid.cells, size)
    if result.contour is None:
        return Sentence("{}: volume {}", cells, volume(result.volume))
    faces = faces_of(settings, result.faces)
    return Sentence("{}: {}, volume {}", cells, faces, volume(result.volume))
