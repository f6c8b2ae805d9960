# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares quads with Blender's Voxel Remesh: their evenness, and their distance to the source.

Usage: scripts/run python3 bench/voxels/quads.py [--depth N] [--shapes NAME...] [--json FILE]

Cells are of one size. Voxel Remesh has its defaults: it moves its vertices onto the source, while
ours stay where the occupancies of cells put them. Only quads count that are more than two cells
from edges of the source that turn by over 30 degrees. Sides and distances are in cells; the spread
of sides is their standard deviation as a share of their mean, the spread of angles is in degrees.
Distances are from vertices, and from the middles of quads, to the source. Armadillo is one of
the models gathered in ../shared beside the checkout.
"""

import argparse
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import prefilter

from bench import solids
from bench.peers.voxel_remesh import VoxelRemesh
from bench.report import Report, add_json_option
from bench.voxels import measures, meshes
from bench.voxels.nearest import Nearest
from bench.voxels.operator_times import suzanne

EDGE_DEGREES, EDGE_CELLS = 30.0, 2.0
SHAPES = ("sphere", "armadillo", "suzanne")
ARMADILLO = "armadillo.obj"
THICKNESS = 1.5  # The add-on's default.
HEAD = (
    "mesh",
    "quads of",
    "quads",
    "sides",
    "spread",
    "1 %",
    "99 %",
    "angles, spread",
    "1 %",
    "99 %",
    "vertices off",
    "95 %",
    "middles off",
    "95 %",
)

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Evenness:
    """Statistics of a quad mesh."""

    count: int
    sides: Floats
    angles: Floats
    vertices: Floats
    middles: Floats

    def row(self, name: str, of: str) -> list[str]:
        """Returns a line of the table."""
        sides, angles = (np.percentile(one, [1, 99]) for one in (self.sides, self.angles))
        cells = [f"{self.sides.mean():.3f}", f"{self.spread:.3f}", *(f"{one:.2f}" for one in sides)]
        cells += [f"{self.angles.std():.1f}", *(f"{one:.0f}" for one in angles)]
        for off in (self.vertices, self.middles):
            cells += [f"{off.mean():.4f}", f"{np.percentile(off, 95):.4f}"]
        return [name, of, f"{self.count}", *cells]

    @property
    def spread(self) -> float:
        """The spread of sides, relative to their mean."""
        return float(self.sides.std() / self.sides.mean())


def evenness(
    positions: Floats, quads: Indices, source: Floats, triangles: Indices, cell: float
) -> Evenness:
    """Measures the quads that are away from edges of their source."""
    corners = positions[quads]
    edges = measures.sharp_edges(source, triangles, EDGE_DEGREES)
    middles = corners.mean(axis=1)
    if len(edges.ends):
        away = Nearest(edges.ends).distances(middles) > EDGE_CELLS * cell
        corners, middles, quads = corners[away], middles[away], quads[away]
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    sides = np.linalg.norm(after, axis=2)
    cosines = np.einsum("ijk,ijk->ij", after, before)
    cosines /= np.maximum(sides * np.linalg.norm(before, axis=2), 1e-300)
    nearest = Nearest(source[triangles])
    return Evenness(
        len(quads),
        sides.ravel() / cell,
        np.degrees(np.arccos(cosines.clip(-1, 1))).ravel(),
        nearest.distances(positions[np.unique(quads)]) / cell,
        nearest.distances(middles) / cell,
    )


def shape(name: str) -> tuple[Floats, Indices]:
    """Returns a shape; of Suzanne, whom Blender makes, a box of her extent."""
    if name == "suzanne":
        return suzanne()
    made = solids.sphere(1.0, 7) if name == "sphere" else meshes.read(meshes.DATA / ARMADILLO)
    return made.positions, made.triangles


def remeshed(name: str, cell: float) -> dict[str, NDArray]:
    """Returns Blender's remesh of a shape, and the shape's triangles."""
    with tempfile.TemporaryDirectory() as folder:
        target, result = Path(folder, f"{name}.npz"), Path(folder, "quads.npz")
        if name != "suzanne":
            positions, triangles = shape(name)
            np.savez(target, positions=positions.astype(np.float32), triangles=triangles)
        VoxelRemesh(target, cell, is_whole=True).made(result)
        return dict(np.load(result))


def contoured(
    source: Floats, triangles: Indices, depth: int, cell: float
) -> "prefilter.QuadContour":
    """Returns the quads of a shape as the add-on makes them."""
    solid = prefilter.as_solid(source, triangles, cell=cell, thickness=THICKNESS, sheets="faces")
    mesh = solid.positions, solid.triangles
    return prefilter.voxelize(*mesh, depth=depth, thickness=THICKNESS).quad_contour(sources=[mesh])


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--depth", type=int, default=7)
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    add_json_option(parser)
    options = parser.parse_args()
    report, rows = Report(), []
    for name in options.shapes:
        if name == "armadillo" and not meshes.DATA.is_dir():
            report.note(f"armadillo is left out: there is no {meshes.DATA}")
            continue
        rows += compared(report, name, options.depth)
    report.table("Quads, and those of Voxel Remesh", HEAD, rows, "quads")
    report.finish(options.json)


def compared(report: Report, name: str, depth: int) -> list[list[str]]:
    """Measures and judges one shape; returns the lines of the table."""
    positions = shape(name)[0]
    box = positions.min(axis=0), positions.max(axis=0)
    low, high = prefilter.cube_around(box, depth=depth)
    cell = float((high - low).max()) / 2**depth
    found = remeshed(name, cell)
    source, triangles = found["source"].astype(np.float64), found["triangles"].astype(np.int64)
    quads = contoured(source, triangles, depth, cell)
    ours = evenness(quads.positions, quads.quads, source, triangles, cell)
    theirs = evenness(
        found["positions"].astype(np.float64), found["faces"], source, triangles, cell
    )
    for what, own, other in (
        ("sides", ours.spread, theirs.spread),
        ("angles", float(ours.angles.std()), float(theirs.angles.std())),
    ):
        claim = f"{name}, spread of {what}: {own:.3f}, at most {other:.3f} as of Voxel Remesh"
        report.verdict(own <= other, claim)
    return [ours.row(name, "Prefilter"), theirs.row(name, "Voxel Remesh")]


if __name__ == "__main__":
    main()
