# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares the operator Voxelize at its defaults with Blender's voxel remesh, in time and memory.

Usage: scripts/run python3 bench/voxels/operator_times.py [--depths N...] [--shapes NAME...]

From an object in Blender to an object in Blender, with cells of the same size, both as they are at
first: volume preserved and attributes carried over. The criteria: at most 0.5 of the CPU time of
all threads, and no more memory. Every round runs each program once.
"""

import argparse
import statistics
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import prefilter

from bench import solids
from bench.peers import Measurement
from bench.peers.voxel_remesh import VoxelRemesh
from bench.peers.voxelize_operator import VoxelizeOperator
from bench.report import Report, add_json_option
from bench.turns import measure, named
from bench.voxels import sharp_shapes

TIME_BAR, MEMORY_BAR = 0.5, 1.0
MILLIONS_DEPTH = 8
Mesh = tuple[np.ndarray, np.ndarray]


def suzanne() -> Mesh:
    """A box of the same extent: the peers make her, with her UV map."""
    made = solids.box((-1.328793, -0.822635, -0.971822), (1.328793, 0.778266, 0.939236))
    return made.positions, made.triangles


def bracket() -> Mesh:
    """A CAD mesh."""
    found = sharp_shapes.shape("bracket")
    return found.positions, found.triangles


def millions() -> Mesh:
    """A smooth solid of 6 million triangles."""
    found = solids.torus(0.7, 0.3, 2450, 1225)
    return found.positions, found.triangles


SHAPES: dict[str, Callable[[], Mesh]] = {
    "suzanne": suzanne,
    "bracket": bracket,
    "millions": millions,
}


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    parser.add_argument("--depths", type=int, nargs="+", default=[8, 9, 10])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in options.shapes:
            positions, triangles = SHAPES[name]()
            target = Path(folder) / f"{name}.npz"
            if name != "suzanne":
                np.savez(target, positions=positions.astype(np.float32), triangles=triangles)
            box = positions.min(axis=0), positions.max(axis=0)
            for depth in [MILLIONS_DEPTH] if name == "millions" else options.depths:
                low, high = prefilter.cube_around(box, depth=depth)
                cell = float((high - low).max()) / 2**depth
                work = named(
                    VoxelizeOperator(target, depth, threads=options.threads),
                    VoxelRemesh(target, cell, is_whole=True, threads=options.threads),
                )
                runs = measure(work, options.rounds, uncounted=0)
                rows.append(judged(report, f"{name}, depth {depth}", *runs.values()))
    head = ["mesh", "CPU s", "of Blender", "ratio", "min - max", "MiB added", "of Blender", "ratio"]
    report.table("Voxelize and Blender's voxel remesh", head, rows, "operators")
    report.finish(options.json)


def judged(
    report: Report, name: str, own: list[Measurement], other: list[Measurement]
) -> list[str]:
    """Judges one mesh at one depth; returns a line of the table."""
    seconds = [statistics.median(run.cpu_seconds for run in runs) for runs in (own, other)]
    pairs = [a.cpu_seconds / b.cpu_seconds for a, b in zip(own, other, strict=True)]
    added = [max(run.peak_mib - run.start_mib for run in runs) for runs in (own, other)]
    ratio, share = statistics.median(pairs), added[0] / added[1]
    report.verdict(ratio <= TIME_BAR, f"{name}: {ratio:.2f} of the CPU time; at most {TIME_BAR}")
    report.verdict(share <= MEMORY_BAR, f"{name}: {share:.2f} of the memory; at most {MEMORY_BAR}")
    return [
        name,
        *(f"{value:.2f}" for value in (*seconds, ratio)),
        f"{min(pairs):.2f} - {max(pairs):.2f}",
        *(f"{value:.0f}" for value in added),
        f"{share:.2f}",
    ]


if __name__ == "__main__":
    main()
