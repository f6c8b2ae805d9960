# SPDX-License-Identifier: GPL-3.0-or-later

"""What voxels made of meshes: numbers for a report, and the places that they are about."""

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
"""Kinds of places."""
_USUAL = 1.5
"""The thickness, in cells, that holds together."""
_SHARE = 0.9
"""Of the area that is thin: so much is kept by the depth that is named."""
_SHEET = 1e-3
"""In cells: what is thinner has no thickness of its own."""


@dataclass(frozen=True)
class Walls:
    """Thin walls.

    Attributes:
        thickness: In cells, of nine tenths of their area at least.
        refinement: How many times smaller cells keep as much of them; infinity for sheets.
        are_few: Whether there is a greater area of sheets.
    """

    thickness: float
    refinement: float
    are_few: bool = False

    @classmethod
    def of(cls, thin: "prefilter.ThinPlaces") -> "Walls | None":
        """Returns what there is of thin walls; sheets alone if there is nothing else."""
        if len(thin.triangles) == 0:
            return None
        is_wall = thin.thickness > _SHEET
        if not is_wall.any():
            return cls(0.0, math.inf)
        walls = prefilter.ThinPlaces(
            thin.triangles[is_wall],
            thin.thickness[is_wall],
            thin.made[is_wall],
            thin.areas[is_wall],
        )
        are_few = bool(thin.areas[is_wall].sum() < thin.areas[~is_wall].sum())
        return cls(walls.thickness_of(_SHARE), walls.refinement(_SHARE), are_few)

    @property
    def levels(self) -> int | None:
        """How many times cells have to be halved; None if no cells are small enough."""
        if self.refinement == math.inf:
            return None
        return math.ceil(math.log2(self.refinement) - 1e-6)


@dataclass(frozen=True)
class Findings:
    """What was found in the mesh of an object, and done about it.

    Attributes:
        name: The object's.
        parts: What hangs together as a solid.
        cavities: Of all parts.
        genus: Of all parts; None if that is not known.
        thin: How many faces were thickened.
        closed: How many holes were closed.
        lost: How many parts.
        walls: The thin ones, if any.
        places: By kind, the faces of the object's own mesh, or the vertices of edges, (n, 2).
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
    """What is said of the meshes that an object was made of.

    Attributes:
        findings: Of what it was, and then of what it was combined with.
        advice: Which depth keeps what is thin.
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
    """Returns what there is to say of a mesh.

    Args:
        name: Of its object.
        mesh: As it was read.
        solid: What was made of it.
        origins: Where the triangles come from that were voxelized; None if from the mesh.
        tree: The voxels.
        closed: How many holes were closed.
        threads: 0 means all processors.
    """
    # Which parts are cavities is only known once they are turned.
    triangles = mesh.triangles.copy()
    triangles[solid.turned] = triangles[solid.turned, ::-1]
    topology = prefilter.mesh_topology(mesh.positions, triangles, threads=threads)
    thin = tree.thin_places
    below = thin.triangles if origins is None else origins[thin.triangles]
    below = np.unique(below[below >= 0])
    lost = tree.lost_parts(mesh.positions, mesh.triangles, topology.part_of, threads=threads)
    of_lost = np.flatnonzero(np.isin(topology.part_of, lost)) if len(lost) else lost
    places = {}
    count = len(below)
    if mesh.own is not None:
        faces_of, own = mesh.own.faces_of, mesh.own
        count = len(faces_of(below)) + int((below >= own.triangles).sum())
        edges = topology.border_edges
        places = {
            THIN: faces_of(below),
            LOST: faces_of(of_lost),
            OPEN: edges[(edges < own.vertices).all(axis=1)],
            TURNED: faces_of(solid.turned),
        }
    walls = Walls.of(tree.thin_walls)
    if len(lost) and walls is None:
        walls = walls_in(tree, mesh.positions, mesh.triangles[of_lost], threads)
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
    """Returns the walls of a mesh that the cells of a tree do not hold together."""
    try:
        thick = prefilter.voxelize(
            positions,
            triangles,
            depth=tree.depth,
            bounds=tree.bounds,
            thickness=_USUAL,
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
    """Returns what was found in the meshes that an object was made of, in one line.

    Args:
        name: The object's.
        report: What was found.
        after: That of the result; None of a volume.
    """
    findings = report.findings
    rows: list[str] = []
    if after is not None:
        rows.append(Sentence(_PARTS, sum(one.parts for one in findings), after.solids))
        cavities = sum(one.cavities for one in findings)
        if cavities != after.cavities:
            rows.append(Sentence(_CAVITIES, cavities, after.cavities))
        before = total_genus(findings)
        if before is not None and after.genus is not None:
            rows.append(Sentence(_GENUS, before, after.genus))
        elif after.genus is not None:
            rows.append(Sentence(_GENUS_AFTER, after.genus))
    for text, count in (
        (_THICKENED, sum(one.thin for one in findings)),
        (_CLOSED, sum(one.closed for one in findings)),
        (_LOST, sum(one.lost for one in findings)),
    ):
        if count:
            rows.append(Sentence(text, count))
    if report.advice is not None:
        rows.append(report.advice)
    return Sentence("object '{}': {}", name, joined("; ", rows))


def total_genus(findings: Sequence[Findings]) -> int | None:
    """Returns the genus of all meshes together, if it is known of each."""
    known = [one.genus for one in findings if one.genus is not None]
    return sum(known) if len(known) == len(findings) else None


def advice_on(
    walls: Sequence[Walls | None], grid: Grid, length: Callable[[float], str], *, by_depth: bool
) -> Sentence | None:
    """Returns which depth, or which voxel size, keeps the thinnest walls as they are."""
    found = [one for one in walls if one is not None]
    if not found:
        return None
    solid = [one for one in found if one.levels is not None]
    if not solid:
        return Sentence(_SHEETS)
    thinnest = max(solid, key=lambda one: one.refinement)
    assert thinnest.levels is not None
    depth = grid.depth + thinnest.levels
    if depth > prefilter.MAX_DEPTH and thinnest.are_few:
        return Sentence(_SHEETS)  # Where these cross, the walls between them have no least width.
    number = f"{thinnest.thickness:.1f}"
    if thinnest.thickness < 0.1:
        number = f"{thinnest.thickness:.1g}"
    if not by_depth:
        return Sentence(_SIZE, number, length(grid.spacing / 2**thinnest.levels))
    if depth > prefilter.MAX_DEPTH:
        return Sentence(_TOO_THIN, number)
    return Sentence(_DEPTH, number, depth)
