# SPDX-License-Identifier: GPL-3.0-or-later

"""Findings about voxelized meshes: numbers for a report, and the faces and edges concerned."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..core.translations import marked
from ..core.wording import Sentence, joined
from .grid import Grid
from .solid_meshes import SolidMesh

Indices = NDArray[np.int32]
THIN, LOST, OPEN, TURNED = "THIN", "LOST", "OPEN", "TURNED"
"""Kinds of reported faces and edges."""
_SAFE_THICKNESS = 1.5
"""Least thickness of walls that do not fall apart, in cells."""
_KEPT_SHARE = 0.9
"""Share of the area of thin walls that is preserved at the advised depth."""
_SHEET_THICKNESS = 1e-3
"""Thickness below which a wall counts as a sheet without thickness, in cells."""


@dataclass(frozen=True)
class Walls:
    """Thin walls.

    Attributes:
        thickness: Least thickness over nine tenths of their area, in cells.
        refinement: Factor by which cells have to shrink to preserve that area; infinity for sheets.
        are_few: Whether sheets have a greater area.
    """

    thickness: float
    refinement: float
    are_few: bool = False

    @classmethod
    def of(cls, thin: "prefilter.ThinPlaces") -> "Walls | None":
        """Measures thin walls, or sheets if there is nothing else."""
        if len(thin.triangles) == 0:
            return None
        is_wall = thin.thickness > _SHEET_THICKNESS
        if not is_wall.any():
            return cls(0.0, math.inf)
        walls = prefilter.ThinPlaces(
            thin.triangles[is_wall],
            thin.thickness[is_wall],
            thin.made[is_wall],
            thin.areas[is_wall],
        )
        are_few = bool(thin.areas[is_wall].sum() < thin.areas[~is_wall].sum())
        return cls(walls.thickness_of(_KEPT_SHARE), walls.refinement(_KEPT_SHARE), are_few)

    @property
    def levels(self) -> int | None:
        """Number of times that cells have to be halved; None if no cells are small enough."""
        if self.refinement == math.inf:
            return None
        return math.ceil(math.log2(self.refinement) - 1e-6)


@dataclass(frozen=True)
class Findings:
    """Findings about the mesh of an object, and repairs made to it.

    Attributes:
        name: Name of the object.
        parts: Number of connected solids.
        cavities: Number of cavities of all parts.
        genus: Genus of all parts; None if it is not known.
        thin: Number of thickened faces.
        closed: Number of closed holes.
        lost: Number of lost parts.
        walls: The thin walls, if any.
        places: By kind, faces of the object's own mesh, (n,), or vertices of edges, (n, 2).
    """

    name: str
    parts: int
    cavities: int
    genus: int | None
    thin: int
    closed: int
    lost: int
    walls: Walls | None
    places: dict[str, Indices] = field(default_factory=dict)


@dataclass(frozen=True)
class Report:
    """Report on the sources of a result.

    Attributes:
        findings: Findings about the original, then about the operands.
        advice: Depth or voxel size that preserves thin walls.
    """

    findings: Sequence[Findings]
    advice: Sentence | None


def find(
    name: str,
    mesh: SolidMesh,
    solid: "prefilter.SolidMesh",
    origins: NDArray[np.int64] | None,
    tree: "prefilter.Octree",
    closed: int,
    threads: int,
) -> Findings:
    """Finds thin, lost, open and flipped faces and edges of a voxelized mesh.

    Args:
        name: Name of its object.
        mesh: The mesh as it was read.
        solid: The solid made of it.
        origins: Source triangle in `mesh` of each voxelized triangle; None if they are the same.
        tree: The voxels.
        closed: Number of closed holes.
        threads: 0 means all processors.
    """
    # Parts can be told from cavities only after flipping inverted triangles.
    triangles = mesh.triangles.copy()
    triangles[solid.turned] = triangles[solid.turned, ::-1]
    topology = prefilter.mesh_topology(mesh.positions, triangles, threads=threads)
    thin = tree.thin_places
    below = thin.triangles if origins is None else origins[thin.triangles]
    below = np.unique(below[below >= 0])
    lost = tree.lost_parts(mesh.positions, mesh.triangles, topology.part_of, threads=threads)
    lost_triangles = np.flatnonzero(np.isin(topology.part_of, lost)) if len(lost) else lost
    places = {}
    count = len(below)
    if mesh.own is not None:
        faces_of, own = mesh.own.faces_of, mesh.own
        count = len(faces_of(below)) + int((below >= own.triangles).sum())
        edges = topology.border_edges
        places = {
            THIN: faces_of(below),
            LOST: faces_of(lost_triangles),
            OPEN: edges[(edges < own.vertices).all(axis=1)],
            TURNED: faces_of(solid.turned),
        }
    walls = Walls.of(tree.thin_walls)
    if len(lost) and walls is None:
        walls = walls_in(tree, mesh.positions, mesh.triangles[lost_triangles], threads)
    return Findings(
        name,
        topology.solids,
        topology.cavities,
        topology.genus,
        count,
        closed,
        len(lost),
        walls,
        {kind: rows for kind, rows in places.items() if len(rows)},
    )


def walls_in(
    tree: "prefilter.Octree",
    positions: NDArray[np.floating],
    triangles: NDArray[np.integer],
    threads: int,
) -> Walls | None:
    """Walls of a mesh that are too thin for the cells of a tree."""
    try:
        thick = prefilter.voxelize(
            positions,
            triangles,
            depth=tree.depth,
            bounds=tree.bounds,
            thickness=_SAFE_THICKNESS,
            threads=threads,
        )
    except ValueError:
        return None  # All have zero area.
    return Walls.of(thick.thin_walls)


_PARTS = marked("parts: {} before, {} after")
_CAVITIES = marked("cavities: {} before, {} after")
_GENUS = marked("genus: {} before, {} after")
_GENUS_AFTER = marked("genus: {} after")
_THICKENED = marked("faces thickened: {}")
_CLOSED = marked("holes closed: {}")
_LOST = marked("parts lost: {}")
_DEPTH = marked("walls of {} cells: depth {} keeps them")
_SIZE = marked("walls of {} cells: voxel size {} keeps them")
_TOO_THIN = marked("walls of {} cells: no depth keeps them")
_SHEETS = marked("sheets: no depth keeps them")


def line(name: str, report: Report, after: "prefilter.MeshTopology | None") -> Sentence:
    """One line of text about the sources of a result.

    Args:
        name: Name of the object.
        report: The report.
        after: Topology of the result; None for a volume.
    """
    findings = report.findings
    rows: list[str] = []
    if after is not None:
        rows.append(Sentence(_PARTS, sum(each.parts for each in findings), after.solids))
        cavities = sum(each.cavities for each in findings)
        if cavities != after.cavities:
            rows.append(Sentence(_CAVITIES, cavities, after.cavities))
        before = total_genus(findings)
        if before is not None and after.genus is not None:
            rows.append(Sentence(_GENUS, before, after.genus))
        elif after.genus is not None:
            rows.append(Sentence(_GENUS_AFTER, after.genus))
    for text, count in (
        (_THICKENED, sum(each.thin for each in findings)),
        (_CLOSED, sum(each.closed for each in findings)),
        (_LOST, sum(each.lost for each in findings)),
    ):
        if count:
            rows.append(Sentence(text, count))
    if report.advice is not None:
        rows.append(report.advice)
    return Sentence("object '{}': {}", name, joined("; ", rows))


def total_genus(findings: Sequence[Findings]) -> int | None:
    """Genus of all meshes together; None if any is not known."""
    known = [each.genus for each in findings if each.genus is not None]
    return sum(known) if len(known) == len(findings) else None


def advice_on(
    walls: Sequence[Walls | None], grid: Grid, length: Callable[[float], str], *, by_depth: bool
) -> Sentence | None:
    """Advises a depth, or a voxel size, that preserves the thinnest walls."""
    thin = [each for each in walls if each is not None]
    if not thin:
        return None
    solid = [each for each in thin if each.levels is not None]
    if not solid:
        return Sentence(_SHEETS)
    thinnest = max(solid, key=lambda each: each.refinement)
    assert thinnest.levels is not None
    depth = grid.depth + thinnest.levels
    if depth > prefilter.MAX_DEPTH and thinnest.are_few:
        return Sentence(_SHEETS)  # Between crossing sheets walls become arbitrarily thin.
    number = f"{thinnest.thickness:.1f}"
    if thinnest.thickness < 0.1:
        number = f"{thinnest.thickness:.1g}"
    if not by_depth:
        return Sentence(_SIZE, number, length(grid.spacing / 2**thinnest.levels))
    if depth > prefilter.MAX_DEPTH:
        return Sentence(_TOO_THIN, number)
    return Sentence(_DEPTH, number, depth)
