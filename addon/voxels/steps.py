# SPDX-License-Identifier: GPL-3.0-or-later

"""What voxelizing and combining have in common: meshes to cells, and cells to a surface."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import prefilter
from numpy.typing import NDArray
from prefilter.workflows.voxels import surfaces
from prefilter.workflows.voxels.empty_results import NO_FILLED_CELL, NothingLeftError

from ..bridge import solids
from ..bridge.files.staging import StagedFile
from ..bridge.layers import COLOR, NORMALS, NewLayer, Wanted
from ..bridge.new_meshes import Contour
from ..bridge.place import Place
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

# What a load takes in seconds, as measured once on two cores; ratios are what counts.
_ALWAYS = 0.01
_PER_TRIANGLE = 1e-6
_VOXELIZING = 0.5e-6
_CONTOURING = {"sharp": 6e-6, "plane": 4e-6, "occupancy": 2e-6, "linear": 2e-6}
_QUADS = 4e-6
_CLEANING = 12e-6
_TRANSFERRING = 3e-6
_WRITING = 1e-8
VOXELIZED, _CONTOURED = 0.5, 0.75
"""What the progress is once the tree is made, and once there is a surface."""


@dataclass(frozen=True)
class Result:
    """A surface, or a staged file of a volume, and numbers about it.

    `volume` is what the surface encloses; of a volume, how much is filled.
    """

    place: Place
    grid: Grid
    volume: float
    faces: int
    contour: Contour | None = None
    staged: StagedFile | None = None
    topology: "prefilter.MeshTopology | None" = None
    """Of the surface."""
    walls: tuple[Walls | None, ...] = ()
    """Those that fell apart."""


@dataclass(frozen=True)
class Operand:
    """A mesh, and how large it is.

    Attributes:
        name: Of the object.
        mesh: What was read.
        measures: Of the mesh.
        left_out: The names of attributes that are not carried.
    """

    name: str
    mesh: SolidMesh
    measures: "prefilter.MeshMeasures"
    left_out: Collection[str] = ()

    @classmethod
    def of(cls, solid: solids.Solid, settings: VoxelSettings) -> "Operand":
        """Returns the mesh of a solid."""
        mesh = solid_mesh(solid.parts)
        measures = prefilter.measure_mesh(mesh.positions, mesh.triangles, threads=settings.threads)
        return cls(solid.name, mesh, measures, solid.left_out)


@dataclass(frozen=True)
class Load:
    """What decides how long meshes in one grid take.

    Attributes:
        box: What the grid is around.
        area: The area of the triangles.
        triangles: How many there are.
        transfers: Whether the result gets values of the nearest points.
    """

    box: Box
    area: float
    triangles: int
    transfers: bool

    @classmethod
    def of(cls, box: Box, operands: Sequence[Operand]) -> "Load":
        """Returns the load of meshes in a box."""
        return cls(
            box,
            sum(one.measures.area for one in operands),
            sum(len(one.mesh.triangles) for one in operands),
            any(one.mesh.layers for one in operands),
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
        per_cell = _QUADS
        if settings.faces == "triangles":
            per_cell = _CONTOURING[settings.interpolant]
            if settings.use_cleanup:
                per_cell += _CLEANING
        if self.transfers:
            per_cell += _TRANSFERRING
        return seconds + per_cell * crossed


def wanted(settings: VoxelSettings) -> Wanted:
    """Returns the layers to read."""
    if getattr(settings, "output", "mesh") == "volume":
        return Wanted(colors=False, uv_maps=False, attributes=False)
    return Wanted(
        colors=settings.use_colors,
        uv_maps=settings.use_uv_maps,
        attributes=settings.use_attributes,
    )


def voxelized(
    operand: Operand,
    grid: Grid,
    settings: VoxelSettings,
    told: "Told",
    progress: Progress,
) -> tuple["prefilter.Octree", Source]:
    """Returns the occupancy of a mesh made a solid, and what it was made of."""
    mesh = operand.mesh
    made = surfaces.occupancy(mesh.positions, mesh.triangles, grid, settings, progress)
    positions, triangles, origins = made.positions, made.triangles, made.origins
    told.tell(operand.name, made)
    if operand.left_out:
        told.warnings.append(Sentence(_LEFT_OUT, operand.name, listed(sorted(operand.left_out))))
    if _adaptivity(settings) and _has_painted_colors(mesh):
        told.notes.append(Sentence(_SMALL, operand.name))
    tree = made.tree
    told.findings.append(
        find(operand.name, mesh, made.solid, origins, tree, made.holes, settings.threads)
    )
    if getattr(settings, "output", "mesh") == "volume":
        return tree, Source(mesh, positions, triangles, origins)
    labels = find_labels(mesh, settings.threads)
    groups = groups_of(find_groups(mesh, labels, grid.spacing), origins)
    return tree, Source(mesh, positions, triangles, origins, labels, groups)


def contoured(
    tree: "prefilter.Octree",
    grid: Grid,
    sources: list[Source],
    solid: solids.Solid,
    place: Place,
    settings: VoxelSettings,
    progress: Progress,
) -> Result:
    """Returns the surface of a tree, with what it gets from its sources.

    Raises:
        ValueError: There is no surface.
    """
    middle = (_CONTOURED - VOXELIZED) / (1.0 - VOXELIZED)
    positions, faces, origins = _surface(tree, sources, settings, share(progress, 0.0, middle))
    if len(faces) == 0:
        raise NothingLeftError(NO_FILLED_CELL)
    transfer = Transfer(sources, positions, faces, origins, grid.spacing, settings.threads)
    face_materials, layers = transfer.run(place, share(progress, middle, 1.0))
    go_on(progress, 1.0)
    local, turned = place.localize(positions, faces)
    edges = face_edges(local, turned, settings.threads)
    contour = Contour(
        local,
        turned,
        solid.materials if settings.use_materials else (),
        face_materials if settings.use_materials else None,
        layers,
        solid.active,
        solid.rendered,
        sharp_angle(settings.smooth_angle) if settings.use_smooth_shading else None,
        edges,
        _shading(local, turned, edges, layers, settings),
        carried_marks(solid.marks, positions, edges, grid.spacing, settings.threads),
        solid.locked_groups,
        solid.kept_modifiers,
    )
    triangles = halves(faces)
    topology = prefilter.mesh_topology(positions, triangles, weld=False, threads=settings.threads)
    return Result(
        place,
        grid,
        prefilter.measure_mesh(positions, triangles, threads=settings.threads).volume,
        len(faces),
        contour,
        topology=topology,
        walls=_apart(tree, topology.solids, sources, settings),
    )


def _apart(
    tree: "prefilter.Octree", parts: int, sources: list[Source], settings: VoxelSettings
) -> tuple[Walls | None, ...]:
    """Returns the walls of sources that fell apart as nothing was to thicken them."""
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
    """Returns a surface, and the sources' triangles that its faces come from, where it is known."""
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
    """Returns whether colors differ between vertices, of which large triangles keep too few."""
    colors = [layer.values for layer in mesh.layers if layer.kind == COLOR and len(layer.values)]
    return any(bool((values != values[0]).any()) for values in colors)


def _shading(
    positions: NDArray[np.float32],
    triangles: NDArray[np.int32],
    edges: "prefilter.MeshEdges",
    layers: Sequence[NewLayer],
    settings: VoxelSettings,
) -> NDArray[np.float32] | None:
    """Returns the normals that large triangles need, where the sources have none of their own."""
    is_closed = 2 * len(edges.vertices) == edges.corners.size and (edges.corners >= 0).all()
    has_normals = any(layer.kind == NORMALS for layer in layers)
    if not (_adaptivity(settings) and settings.use_smooth_shading and is_closed) or has_normals:
        return None
    return weighted_normals(positions, triangles, edges, sharp_angle(settings.smooth_angle))


_LEFT_OUT = marked("object '{}': attributes of types that cannot be kept: {}")
_SMALL = marked("object '{}' has painted colors, for which triangles stay small")


class Told:
    """What is odd about meshes, and what was done about it, in words."""

    def __init__(self) -> None:
        """Starts with nothing."""
        self.warnings: list[str] = []
        self.notes: list[str] = []
        self.findings: list[Findings] = []

    def sum_up(
        self, result: Result, findings: Sequence[Findings], settings: VoxelSettings
    ) -> Report:
        """Adds a line of what became of meshes: a warning if parts are lost."""
        walls = [*(one.walls for one in findings), *result.walls]
        by_depth = settings.resolution == "depth"
        found = Report(findings, advice_on(walls, result.grid, length, by_depth=by_depth))
        summed = line(result.place.name, found, result.topology)
        (self.warnings if any(one.lost for one in findings) else self.notes).append(summed)
        return found

    def add(self, other: "Told") -> None:
        """Adds what was told elsewhere."""
        self.warnings += other.warnings
        self.notes += other.notes
        self.findings += other.findings

    def tell(self, name: str, made: surfaces.Occupancy) -> None:
        """Adds what was found in the mesh of an object."""
        warnings, notes = surfaces.repair_lines(name, made)
        self.warnings += warnings
        self.notes += notes


def faces_of(settings: VoxelSettings, count: int) -> Sentence:
    """Returns how many faces there are, in words."""
    return amount(count, "quad") if settings.faces == "quads" else amount(count, "triangle")


def told(result: Result, settings: VoxelSettings) -> str:
    """Returns numbers about a result, in words."""
    size = length(result.grid.spacing)
    cells = Sentence("'{}' in {}³ cells of {}", result.place.name, result.grid.cells, size)
    if result.contour is None:
        return Sentence("{}: volume {}", cells, volume(result.volume))
    faces = faces_of(settings, result.faces)
    return Sentence("{}: {}, volume {}", cells, faces, volume(result.volume))
