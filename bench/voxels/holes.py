# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures patches over holes whose surface is known.

Usage: scripts/run python3 bench/voxels/holes.py [--json FILE] [--fill-holes PROGRAM]

Columns per hole and method: distances of the patch from the original surface, mean and
largest; the angle between triangles on either side of the border, at the 95th percentile; the error
of the volume; triangles, and CPU time on one thread, with the search for the borders.
`--fill-holes` is the program built from bench/peers/fill_holes.cpp.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import prefilter

from bench.report import Report, add_json_option
from bench.solids import mesh_volume, sphere, torus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
SAMPLES = 20_000
METHODS = ("smooth", "flat", "fan")


@dataclass(frozen=True)
class Hole:
    """A mesh with a hole, its original volume, and the distance of points from the original."""

    name: str
    positions: Floats
    triangles: Ints
    volume: float
    distance: Callable[[Floats], Floats]


def holes() -> Iterator[Hole]:
    """Caps of spheres of two densities, and the side of a torus."""
    for rounds, degrees in ((4, 30), (5, 10), (5, 20), (5, 30), (5, 45), (5, 60), (7, 45)):
        made = sphere(1.0, rounds)
        points, triangles = made.positions, made.triangles
        middles = points[triangles].mean(axis=1)
        along = middles @ np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])
        kept = along / np.linalg.norm(middles, axis=1) < np.cos(np.radians(degrees))
        yield Hole(
            f"sphere of {len(triangles):,} triangles, a cap of {degrees}&deg;",
            points,
            triangles[kept],
            mesh_volume(points, triangles),
            lambda p: np.abs(np.linalg.norm(p, axis=1) - 1),
        )
    made = torus(1.0, 0.4, 160, 64)
    points, triangles = made.positions, made.triangles
    middles = points[triangles].mean(axis=1)

    def distance(p: Floats) -> Floats:
        return np.abs(np.hypot(np.hypot(p[:, 0], p[:, 1]) - 1, p[:, 2]) - 0.4)

    for name, center in (("outer", (1.4, 0, 0)), ("inner", (0.6, 0, 0)), ("upper", (1, 0, 0.4))):
        kept = np.linalg.norm(middles - center, axis=1) > 0.3
        title = f"torus, {name} side"
        yield Hole(title, points, triangles[kept], mesh_volume(points, triangles), distance)


@dataclass(frozen=True)
class Patch:
    """A mesh with its hole closed, its own triangles first."""

    positions: Floats
    triangles: Ints
    seconds: float


def ours(hole: Hole, method: str) -> Patch:
    """Closes a hole by close_holes; the fastest of three times."""
    times = []
    for _ in range(3):
        began = resource.getrusage(resource.RUSAGE_SELF)
        found = prefilter.close_holes(hole.positions, hole.triangles, method=method, threads=1)
        ended = resource.getrusage(resource.RUSAGE_SELF)
        times.append(ended.ru_utime + ended.ru_stime - began.ru_utime - began.ru_stime)
    return Patch(found.positions, found.triangles, min(times))


def cgal(hole: Hole, program: Path) -> Patch:
    """Closes a hole by CGAL; the time for files is not counted."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "in.off"), Path(folder, "out.off")
        used, triangles = np.unique(hole.triangles, return_inverse=True)
        with source.open("w") as file:
            file.write(f"OFF\n{len(used)} {len(hole.triangles)} 0\n")
            np.savetxt(file, hole.positions[used], "%.17g")
            rows = triangles.reshape(-1, 3)
            np.savetxt(file, np.c_[np.full(len(rows), 3), rows], "%d")
        done = subprocess.run([program, source, target], check=True, capture_output=True, text=True)
        words = target.read_text().split()
    count, faces = int(words[1]), int(words[2])
    numbers = np.array(words[4:], float)
    positions = numbers[: 3 * count].reshape(-1, 3)
    triangles = numbers[3 * count :].reshape(faces, 4)[:, 1:].astype(int)
    return Patch(positions, triangles, float(done.stdout))


def border_angles(patch: Patch, first: int) -> Floats:
    """Degrees between triangles on either side of the border."""
    a, b, c = np.moveaxis(patch.positions[patch.triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    edges = np.sort(patch.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort(edges.T)
    pairs = order[:-1][(edges[order[:-1]] == edges[order[1:]]).all(axis=1)] // 3
    others = order[1:][(edges[order[:-1]] == edges[order[1:]]).all(axis=1)] // 3
    across = (pairs < first) != (others < first)
    cosines = np.einsum("ij,ij->i", normals[pairs[across]], normals[others[across]])
    return np.degrees(np.arccos(np.clip(cosines, -1, 1)))


def row(hole: Hole, name: str, patch: Patch) -> list[str]:
    """Returns a line of the table."""
    first = len(hole.triangles)
    caps = patch.positions[patch.triangles[first:]]
    areas = np.linalg.norm(np.cross(caps[:, 1] - caps[:, 0], caps[:, 2] - caps[:, 0]), axis=1)
    random = np.random.default_rng(0)
    chosen = random.choice(len(caps), SAMPLES, p=areas / areas.sum())
    points = np.einsum("nc,ncd->nd", random.dirichlet((1, 1, 1), SAMPLES), caps[chosen])
    away = hole.distance(points)
    angle = np.percentile(border_angles(patch, first), 95)
    error = 100 * (mesh_volume(patch.positions, patch.triangles) / hole.volume - 1)
    distances = [f"{away.mean():.4f}", f"{away.max():.4f}", f"{angle:.1f}"]
    cost = [f"{len(caps):,}", f"{patch.seconds:.3f}"]
    return [hole.name, name, *distances, f"{error:+.2f}", *cost]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_json_option(parser)
    parser.add_argument("--fill-holes", type=Path)
    options = parser.parse_args()
    head = ["hole", "method", "mean distance", "largest", "angle at the border, &deg;"]
    head += ["volume, %", "triangles", "CPU s"]
    rows = []
    for hole in holes():
        rows += [row(hole, method, ours(hole, method)) for method in METHODS]
        if options.fill_holes:
            rows.append(row(hole, "CGAL", cgal(hole, options.fill_holes)))
    report = Report()
    report.table("Patches over holes in known surfaces", head, rows, "patches")
    report.write(options.json)


if __name__ == "__main__":
    main()
