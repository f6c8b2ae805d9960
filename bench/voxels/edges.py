# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures how well contours keep the edges of shapes and the rims of booleans.

Usage: scripts/run python3 bench/voxels/edges.py [--shapes NAME...] [--pairs NAME+NAME...]
    [--sizes N...] [--interpolants NAME[-alone][+clean][@ADAPTIVITY]...]

sharp gets the shapes as its sources, sharp-alone does not.

The columns: distances of true edges from the surface and from its sharp edges, mean, 95th
percentile and largest; the largest distance of a corner from a vertex; the share of the area
more than 10 degrees off; two cells from edges, the mean error of normals in degrees and the
vertices' root mean square distance; open and crowded edges; pairs of triangles that cut each other;
the share of triangles with an angle below 15 degrees; triangles; seconds. Lengths are in cells.

Truth of booleans is manifold3d's (PyPI); without it they are left out. Self-intersections are
counted by a program that CMake builds where CGAL is; -1 stands where it is missing.
"""

import argparse
import inspect
import re
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.voxels import booleans, measures, sharp_shapes
from bench.voxels.sharp_shapes import Shape

HEAD = (
    "subject",
    "contour",
    "surf mean",
    "95 %",
    "edge mean",
    "95 %",
    "most",
    "corner",
    "area off %",
    "normal",
    "vertex rms",
    "open",
    "crowded",
    "cuts",
    "thin %",
    "triangles",
    "s",
)
MARGIN = 2  # Cells on every side.
NO_EDGES = measures.Edges(np.zeros((0, 2, 3)), np.zeros(0))
WEDGE_DEGREES = 40.0
EDGE_MEAN, EDGE_95, AREA = 0.02, 0.1, 0.001


@dataclass(frozen=True)
class Subject:
    """The voxelized meshes, and the true surface with its edges."""

    name: str
    sources: tuple[Shape, ...]
    operation: str
    truth: Shape
    edges: measures.Edges


@dataclass(frozen=True)
class Contour:
    """The options of a contour."""

    interpolant: str
    alone: bool  # without sources
    cleanup: bool
    adaptivity: float

    @classmethod
    def named(cls, text: str) -> "Contour":
        """Reads NAME[-alone][+clean][@ADAPTIVITY].

        Raises:
            ValueError: It has another form.
        """
        found = re.fullmatch(r"([a-z]+)(-alone)?(\+clean)?(?:@([0-9.]+))?", text)
        if not found:
            raise ValueError(f"{text!r} is not of the form NAME[-alone][+clean][@ADAPTIVITY]")
        return cls(found[1], bool(found[2]), bool(found[3]), float(found[4] or 0))

    @property
    def name(self) -> str:
        """The name as written on the command line."""
        end = f"@{self.adaptivity:g}" if self.adaptivity else ""
        alone = "-alone" if self.alone else ""
        return f"{self.interpolant}{alone}{'+clean' if self.cleanup else ''}{end}"


def single(name: str) -> Subject:
    """One shape, by itself."""
    shape = sharp_shapes.shape(name)
    edges = measures.sharp_edges(shape.positions, shape.triangles, sharp_shapes.SHARP_DEGREES)
    return Subject(name, (shape,), "", shape, edges)


def box_around(shapes: Sequence[Shape], size: int) -> tuple[np.ndarray, float]:
    """The low corner of a cube of cells around shapes, and the side of a cell."""
    points = np.concatenate([shape.positions for shape in shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    cell = float((high - low).max()) / (size - 2 * MARGIN)
    return (low + high) / 2 - cell * size / 2, cell


def contour(subject: Subject, size: int, how: Contour) -> tuple[np.ndarray, np.ndarray, float]:
    """Returns the surface, and the seconds of its contour alone."""
    import prefilter

    low, cell = box_around(subject.sources, size)
    bounds = (low, low + size * cell)
    depth = size.bit_length() - 1
    trees = [
        prefilter.voxelize(s.positions, s.triangles, depth=depth, bounds=bounds)
        for s in subject.sources
    ]
    tree = trees[0]
    for other in trees[1:]:
        tree = getattr(tree, subject.operation)(other)
    options: dict[str, Any] = {"interpolant": how.interpolant, "cleanup": how.cleanup}
    known = inspect.signature(tree.contour).parameters
    if how.interpolant == "sharp" and "sources" in known and not how.alone:
        options["sources"] = [(s.positions, s.triangles) for s in subject.sources]
    if how.adaptivity:
        options["adaptivity"] = how.adaptivity
    began = time.perf_counter()
    positions, triangles = tree.contour(**options)
    seconds = time.perf_counter() - began
    return np.asarray(positions, np.float64), np.asarray(triangles, np.int64), seconds


@dataclass(frozen=True)
class Result:
    """All measures of one surface."""

    edges: measures.EdgeErrors
    surface: measures.SurfaceErrors
    sound: measures.Soundness
    thin: float
    triangles: int
    seconds: float

    @property
    def row(self) -> list[str]:
        """The columns of the table that follow the names."""
        return [
            *(f"{value:.4f}" for value in self.edges.numbers),
            f"{100 * self.surface.wrong:.3f}",
            f"{self.surface.normal_mean:.3f}",
            f"{self.surface.vertex_rms:.5f}",
            str(self.sound.open_edges),
            str(self.sound.crowded_edges + self.sound.crowded_vertices),
            str(self.sound.intersections),
            f"{100 * self.thin:.2f}",
            str(self.triangles),
            f"{self.seconds:.2f}",
        ]


def measured(
    subject: Subject, positions: np.ndarray, triangles: np.ndarray, cell: float, seconds: float
) -> Result:
    """Measures a surface of any program."""
    truth = subject.truth
    return Result(
        measures.edge_errors(positions, triangles, subject.edges, cell),
        measures.surface_errors(
            positions, triangles, truth.positions, truth.triangles, subject.edges, cell
        ),
        measures.soundness(positions, triangles),
        float((measures.smallest_angles(positions, triangles) < 15).mean()),
        len(triangles),
        seconds,
    )


def subjects_of(options: argparse.Namespace) -> list[Subject]:
    """The requested shapes and booleans that are available."""
    found = []
    for name in options.shapes:
        try:
            found.append(single(name))
        except OSError as error:
            print(f"{name} is left out: {error}")
    if options.pairs and booleans.missing():
        print(f"booleans are left out: {booleans.missing()} is missing")
        return found
    names = options.pairs
    if names == ["all"]:
        names = ["+".join(pair[:2]) for pair in sharp_shapes.PAIRS]
    numbers = {(first, second): number for first, second, number in sharp_shapes.PAIRS}
    for name in names:
        first, second = name.split("+")
        for operation in options.operations:
            number = numbers.get((first, second), 0)
            found.append(boolean(first, second, operation, number))
    return found


def boolean(first: str, second: str, operation: str, number: int = 0) -> Subject:
    """Two shapes combined; its edges are the rims, where faces of both meet.

    Rims of wedges below 40 degrees are left out: their tips leave cells mostly empty.
    """
    sources = sharp_shapes.pair(first, second, number)
    truth, rims = booleans.combined(sources, operation)
    wide = rims.degrees <= 180 - WEDGE_DEGREES
    rims = measures.Edges(rims.ends[wide], rims.degrees[wide])
    return Subject(f"{first} {operation} {second}", sources, operation, truth, rims)


def add_subjects(parser: argparse.ArgumentParser) -> None:
    """Adds the options that select the measurements."""
    pairs = ", ".join("+".join(pair[:2]) for pair in sharp_shapes.PAIRS)
    parser.add_argument("--shapes", nargs="*", default=list(sharp_shapes.MAKERS))
    parser.add_argument("--pairs", nargs="*", default=[], help=f"'all', or of {pairs}")
    parser.add_argument("--operations", nargs="+", default=list(booleans.OPERATORS))
    parser.add_argument("--sizes", type=int, nargs="+", default=[128])
    add_json_option(parser)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_subjects(parser)
    parser.add_argument(
        "--interpolants",
        nargs="+",
        default=["occupancy", "plane"],
        metavar="NAME[-alone][+clean][@CELLS]",
    )
    options = parser.parse_args()
    report = Report()
    subjects = subjects_of(options)
    for size in options.sizes:
        rows = []
        judged = []
        for subject in subjects:
            _, cell = box_around(subject.sources, size)
            for text in options.interpolants:
                how = Contour.named(text)
                positions, triangles, seconds = contour(subject, size, how)
                found = measured(subject, positions, triangles, cell, seconds)
                rows.append([subject.name, how.name, *found.row])
                print(" ".join(rows[-1]), flush=True)
                if how.interpolant == "sharp" and not how.alone:
                    judged.append((f"{subject.name}, {how.name}", found))
        report.table(f"{size} cells along an axis", HEAD, rows)
        for name, found in judged:
            judge(report, f"{name}, {size}", found)
    report.finish(options.json)


def judge(report: Report, name: str, found: Result) -> None:
    """Judges the measures by the bars."""
    edge = found.edges
    mean, high = (
        max(edge.surface_mean, edge.crease_mean),
        max(edge.surface_95, edge.crease_95),
    )
    report.verdict(
        mean <= EDGE_MEAN and high <= EDGE_95 and found.surface.wrong <= AREA,
        f"{name}: edges missed by {mean:.4f} on average and {high:.4f} at the 95th percentile, "
        f"{100 * found.surface.wrong:.3f} % of the area off; {EDGE_MEAN}, {EDGE_95} and "
        f"{100 * AREA} % are allowed",
    )
    report.verdict(
        found.sound.is_sound,
        f"{name}: {found.sound.open_edges} open edges, "
        f"{found.sound.crowded_edges} crowded edges, {found.sound.crowded_vertices} crowded "
        f"vertices, {found.sound.intersections} self-intersections",
    )


if __name__ == "__main__":
    main()
