# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures as_solid on hard meshes: the preserved share of their surface, and the cost.

Usage: scripts/run python3 bench/voxels/hard.py [NAME...] [--cells N] [--json FILE]
           [--alpha-wrap PROGRAM]

Columns per mesh: the share of its surface within 3 cells of the contour, before (as voxelize takes
the mesh with its holes closed) and after as_solid; the volume as a share of the true one;
the CPU time of as_solid, close_holes and voxelize together, and of CGAL's alpha wrap by the program
built from bench/peers/alpha_wrap.cpp, if given. Missing models are left out.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import prefilter

from bench.report import Report, add_json_option
from bench.solids import mesh_volume
from bench.voxels.hard_meshes import HardMesh, hard_meshes, read_meshes

NEAR = 3.0  # Cells.
SAMPLES = 20_000


@dataclass(frozen=True)
class Outcome:
    """The result for a mesh.

    Attributes:
        kept: The share of its surface near the contour; 0 where there is none.
        volume: Of the contour.
        seconds: CPU time.
    """

    kept: float
    volume: float
    seconds: float
    triangles: int
    report: str = ""


def cpu_seconds() -> float:
    """CPU time of this process so far."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def samples(mesh: HardMesh, count: int = SAMPLES) -> np.ndarray:
    """Points spread evenly over the surface."""
    random = np.random.default_rng(0)
    a, b, c = np.moveaxis(mesh.positions[mesh.triangles], 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chosen = random.choice(len(areas), count, p=areas / areas.sum())
    u, v = random.random((2, count, 1))
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    return a[chosen] + u * (b - a)[chosen] + v * (c - a)[chosen]


def kept_share(mesh: HardMesh, positions: np.ndarray, triangles: np.ndarray, near: float) -> float:
    """Returns the share of a mesh's surface within `near` of another mesh."""
    if len(triangles) == 0:
        return 0.0
    _, _, distances = prefilter.nearest_points(samples(mesh), positions, triangles)
    return float((distances <= near).mean())


def outcome(mesh: HardMesh, cell: float, mends: bool) -> Outcome:
    """Voxelizes, with as_solid or without."""
    start = cpu_seconds()
    positions, triangles = mesh.positions, mesh.triangles
    report = ""
    if mends:
        solid = prefilter.as_solid(positions, triangles, cell=cell)
        positions, triangles = solid.positions, solid.triangles
        names = (
            "parts",
            "welded_vertices",
            "duplicate_faces",
            "turned_faces",
            "turned_parts",
            "thickened_parts",
            "filled_parts",
        )
        report = " ".join(
            f"{n.split('_')[0]}={getattr(solid, n)}" for n in names if getattr(solid, n)
        )
    closed = prefilter.close_holes(positions, triangles)
    bounds, depth = cube(mesh, cell)
    octree = prefilter.voxelize(closed.positions, closed.triangles, depth=depth, bounds=bounds)
    seconds = cpu_seconds() - start
    found = octree.contour(interpolant="plane")
    kept = kept_share(mesh, *found, NEAR * cell)
    return Outcome(kept, octree.volume, seconds, len(found[1]), report)


def cube(mesh: HardMesh, cell: float) -> tuple[tuple[np.ndarray, np.ndarray], int]:
    """A root around the mesh with cells of this side, and its depth."""
    named = mesh.positions[np.unique(mesh.triangles)]
    low, high = named.min(axis=0), named.max(axis=0)
    depth = int(np.ceil(np.log2((high - low).max() / cell + 8)))
    middle, half = (low + high) / 2, cell * 2**depth / 2
    return (middle - half, middle + half), depth


def alpha_wrap(program: Path, mesh: HardMesh, cell: float) -> Outcome:
    """CGAL's alpha wrap, with details of two cells and an offset of a half."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "in.off"), Path(folder, "out.off")
        with source.open("w") as file:
            file.write(f"OFF\n{len(mesh.positions)} {len(mesh.triangles)} 0\n")
            np.savetxt(file, mesh.positions, "%.17g")
            np.savetxt(file, np.insert(mesh.triangles, 0, 3, axis=1), "%d")
        arguments = [str(program), str(source), str(target), str(2 * cell), str(cell / 2)]
        try:
            done = subprocess.run(
                arguments, capture_output=True, text=True, timeout=600, check=True
            )
        except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
            return Outcome(0.0, 0.0, float("nan"), 0)
        words = target.read_text().split()
    count, faces = int(words[1]), int(words[2])
    positions = np.array(words[4 : 4 + 3 * count], float).reshape(-1, 3)
    triangles = np.array(words[4 + 3 * count :], float).reshape(faces, -1)[:, 1:4].astype(int)
    kept = kept_share(mesh, positions, triangles, NEAR * cell)
    return Outcome(kept, mesh_volume(positions, triangles), float(done.stdout), len(triangles))


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--cells", type=int, default=128, help="along the longest side")
    parser.add_argument("--alpha-wrap", type=Path, metavar="PROGRAM")
    parser.add_argument("--reports", action="store_true", help="what as_solid did, too")
    add_json_option(parser)
    options = parser.parse_args()
    head = ["mesh", "triangles", "before", "kept", "volume", "CPU s"]
    head += ["alpha wrap, kept", "CPU s"] if options.alpha_wrap else []
    rows = []
    for name, mesh in {**hard_meshes(), **dict(read_meshes())}.items():
        if options.names and name not in options.names:
            continue
        low, high = (
            f(mesh.positions[mesh.triangles].reshape(-1, 3), axis=0) for f in (np.min, np.max)
        )
        cell = float((high - low).max()) / options.cells
        before, after = outcome(mesh, cell, False), outcome(mesh, cell, True)
        volume = f"{after.volume / mesh.volume:.4f}" if mesh.volume else ""
        columns = [
            name,
            str(len(mesh.triangles)),
            f"{before.kept:.2%}",
            f"{after.kept:.2%}",
            volume,
            f"{after.seconds:.3f}",
        ]
        if options.alpha_wrap:
            peer = alpha_wrap(options.alpha_wrap, mesh, cell)
            columns += [f"{peer.kept:.2%}", f"{peer.seconds:.2f}"]
        rows.append(columns)
        if options.reports:
            print(f"{name}: {after.report}", flush=True)
    report = Report()
    report.table(f"{options.cells} cells along the longest side", head, rows, "meshes")
    report.write(options.json)


if __name__ == "__main__":
    main()
