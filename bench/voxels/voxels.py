# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares voxelize and contour with OpenVDB and Blender's voxel remesh, in time and memory.

Usage: scripts/run python3 bench/voxels/voxels.py [MODEL...] [--sizes N...] [--rounds N]

Needs the models gathered in ../shared beside the checkout. A peer whose requirements are missing is
left out, with a message.

The criteria: in CPU time of one thread, voxelize takes at most 0.25 of OpenVDB's meshToVolume, and
with the contour at most 0.3 of Blender's voxel remesh; neither takes more memory than they; two
threads are at least 1.7 times as fast as one; depth 12 stays below 4 GB. Everyone has the same
cells. Every round runs each program once; ends with status 1 where a criterion does not hold.
"""

import argparse
import statistics
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers import Measurement, Peer
from bench.peers.octree import Octree
from bench.peers.vdb import OpenVdb
from bench.peers.voxel_remesh import VoxelRemesh
from bench.report import Report, add_json_option
from bench.turns import measure
from bench.voxels import meshes

MODELS = ("armadillo.obj", "igea_tri.ply")
DEEPEST = ("armadillo.obj", 12, 4e9)
MARGIN = 2  # Cells on every side.
VOXELIZE_BAR, REMESH_BAR, THREADS_BAR = 0.25, 0.3, 1.7
Runs = list[Measurement]


@dataclass(frozen=True)
class Subject:
    """A model as the programs get it, and the cube that it is voxelized in."""

    name: str
    mesh: Path
    depth: int
    low: tuple[float, ...]
    side: float
    surface_cells: float  # Cells that the surface crosses, on average over its position.

    @property
    def cell(self) -> float:
        """The side of a cell."""
        return self.side / 2**self.depth


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=MODELS)
    parser.add_argument("--data", type=Path, default=meshes.DATA, help="the models' folder")
    parser.add_argument("--sizes", type=int, nargs="+", default=[256, 1024], metavar="N")
    parser.add_argument("--rounds", type=int, default=5, help="how often (default: %(default)s)")
    parser.add_argument("--interpolant", default="occupancy")
    parser.add_argument("--no-deep", action="store_true", help="leave out depth 12")
    add_json_option(parser)
    options = parser.parse_args()
    for name in options.models:
        if not (options.data / name).exists():
            parser.error(f"there is no '{options.data / name}'")
    report = Report()
    for peer in (OpenVdb, VoxelRemesh):
        if peer.missing():
            report.note(f"{peer.__name__} is left out: it needs {peer.missing()}")
    with tempfile.TemporaryDirectory() as folder:
        for name in options.models:
            for size in options.sizes:
                subject = prepared(options.data / name, Path(folder), size.bit_length() - 1)
                compare(report, subject, options)
        if not options.no_deep:
            name, depth, limit = DEEPEST
            deepest(report, prepared(options.data / name, Path(folder), depth), limit)
    report.finish(options.json)


def prepared(path: Path, folder: Path, depth: int) -> Subject:
    """Writes the mesh as arrays, and returns the work on it."""
    model = meshes.read(path)
    target = folder / f"{path.stem}.npz"
    if not target.exists():
        np.savez(
            target,
            positions=model.positions.astype(np.float32),
            triangles=model.triangles.astype(np.int32),
        )
    low, high = model.positions.min(axis=0), model.positions.max(axis=0)
    side = float((high - low).max()) / (1 - 2 * MARGIN / 2**depth)
    # A plane of area A and normal n meets A (|nx| + |ny| + |nz|) / cell^2 cells.
    met = np.abs(model.area_vectors).sum() / (side / 2**depth) ** 2
    corner = tuple(((low + high) / 2 - side / 2).tolist())
    return Subject(path.stem, target, depth, corner, side, float(met))


def compare(report: Report, subject: Subject, options: argparse.Namespace) -> None:
    """Measures one model at one size."""

    def ours(interpolant: str = "", threads: int = 1) -> Octree:
        return Octree(
            subject.mesh,
            subject.low,
            subject.side,
            subject.depth,
            interpolant=interpolant,
            threads=threads,
        )

    work: dict[str, Peer] = {
        "voxelize": ours(),
        "voxelize, 2 threads": ours(threads=2),
        "voxelize + contour": ours(options.interpolant),
        "voxelize + contour, 2 threads": ours(options.interpolant, 2),
    }
    if not OpenVdb.missing():
        work["OpenVDB meshToVolume"] = OpenVdb(subject.mesh, subject.cell)
    if not VoxelRemesh.missing():
        work["Blender voxel remesh"] = VoxelRemesh(subject.mesh, subject.cell)
    runs = measure(work, options.rounds, uncounted=0)
    size = 2**subject.depth
    rows = [row(key, found, subject) for key, found in runs.items()]
    head = ["program", "CPU s", "min - max", "ns / cell", "wall s", "peak MiB", "of it before"]
    cells = f"{subject.surface_cells / 1e6:.2f} million cells at the surface"
    report.table(f"{subject.name}, {size} x {size} x {size}, {cells}", head, rows)
    judge(report, runs, "voxelize", "OpenVDB meshToVolume", VOXELIZE_BAR)
    judge(report, runs, "voxelize + contour", "Blender voxel remesh", REMESH_BAR)
    for key in ("voxelize", "voxelize + contour"):
        pairs = zip(runs[key], runs[f"{key}, 2 threads"], strict=True)
        gain = statistics.median(one.seconds / two.seconds for one, two in pairs)
        report.verdict(
            gain >= THREADS_BAR,
            f"{subject.name}, {size}: {key} is {gain:.2f} times as fast with two threads; at least "
            f"{THREADS_BAR} is asked for",
        )


def row(key: str, runs: Runs, subject: Subject) -> list[str]:
    """Returns a line of the table."""
    cpu = [run.cpu_seconds for run in runs]
    middle = statistics.median(cpu)
    return [
        key,
        f"{middle:.3f}",
        f"{min(cpu):.3f} - {max(cpu):.3f}",
        f"{1e9 * middle / subject.surface_cells:.0f}",
        f"{statistics.median(run.seconds for run in runs):.3f}",
        f"{max(run.peak_mib for run in runs):.0f}",
        f"{statistics.median(run.start_mib for run in runs):.0f}",
    ]


def judge(report: Report, runs: dict[str, Runs], key: str, peer: str, bar: float) -> None:
    """Compares CPU time and memory with an available peer."""
    if peer not in runs:
        return
    middles = [statistics.median(run.cpu_seconds for run in runs[name]) for name in (key, peer)]
    ratio = middles[0] / middles[1]
    report.verdict(ratio <= bar, f"{key} takes {ratio:.3f} of {peer}; at most {bar} is asked for")
    own, other = (max(r.peak_mib - r.start_mib for r in runs[name]) for name in (key, peer))
    whole, whole_other = (max(r.peak_mib for r in runs[name]) for name in (key, peer))
    report.verdict(
        own <= other and whole <= whole_other,
        f"{key} takes {own:.0f} MiB beyond what was there before, {peer} {other:.0f}; the whole "
        f"process {whole:.0f} and {whole_other:.0f}",
    )


def deepest(report: Report, subject: Subject, limit: float) -> None:
    """Measures the greatest depth."""
    peer = Octree(subject.mesh, subject.low, subject.side, subject.depth, threads=2)
    run = peer.measure()
    report.verdict(
        run.peak_mib * 2**20 < limit,
        f"{subject.name} at depth {subject.depth}: {run.seconds:.1f} s with two threads, "
        f"{run.peak_mib:.0f} MiB; less than {limit / 1e9:g} GB is asked for",
    )


if __name__ == "__main__":
    main()
