# SPDX-License-Identifier: GPL-3.0-or-later

"""Times sharp contours with Clean Up against "plane" contours without, on the same octree.

Usage: scripts/run python3 bench/voxels/contour_times.py [--depths N...] [--rounds N] [--threads N]

The criterion: sharp and Clean Up together take at most 1.5 times as long. Each round takes every
contour once, so that other work on the machine slows all; times are medians of wall time, and the
ratio is over pairs in one round.
"""

import argparse
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.voxels import edges, meshes, sharp_shapes
from bench.voxels.corpus import fitted
from bench.voxels.sharp_shapes import Shape

BAR = 1.5
FILES = ("armadillo.obj", "igea_tri.ply")
SHAPES = ("fandisk", "bracket")


def shapes() -> list[Shape]:
    """Two with edges, and two of scans that are there."""
    found = [sharp_shapes.shape(name) for name in SHAPES if name != "fandisk" or _has(name)]
    for name in FILES:
        if (meshes.DATA / name).exists():
            read = meshes.read(meshes.DATA / name)
            found.append(fitted(Path(name).stem, read.positions, read.triangles))
    return found


def _has(name: str) -> bool:
    return (meshes.DATA / f"{name}.obj").exists()


def timed(work: Callable[[], Any]) -> tuple[float, float]:
    """Wall and processor time."""
    began, cpu = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - began, time.process_time() - cpu


def main() -> None:
    """Measures and prints."""
    import prefilter

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--depths", type=int, nargs="+", default=[7, 9])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    add_json_option(parser)
    options = parser.parse_args()
    report, rows, ratios = Report(), [], []
    for shape in shapes():
        for depth in options.depths:
            low, cell = edges.box_around([shape], 2**depth)
            bounds = (low, low + cell * 2**depth)
            mesh = (shape.positions, shape.triangles)
            tree = prefilter.voxelize(*mesh, depth=depth, bounds=bounds)
            works: dict[str, Callable[[], Any]] = {
                "plane": lambda t=tree: t.contour(
                    interpolant="plane", cleanup=False, threads=options.threads
                ),
                "plane+clean": lambda t=tree: t.contour(
                    interpolant="plane", threads=options.threads
                ),
                "sharp": lambda t=tree, m=mesh: t.contour(
                    interpolant="sharp", sources=[m], cleanup=False, threads=options.threads
                ),
                "sharp+clean": lambda t=tree, m=mesh: t.contour(
                    interpolant="sharp", sources=[m], threads=options.threads
                ),
            }
            rounds = [
                {name: timed(work) for name, work in works.items()} for _ in range(options.rounds)
            ]
            ratio = [
                statistics.median(r["sharp+clean"][k] / r["plane"][k] for r in rounds)
                for k in (0, 1)
            ]
            middles = [f"{statistics.median(r[name][0] for r in rounds):.3f}" for name in works]
            rows.append([shape.name, str(2**depth), *middles, *(f"{r:.2f}" for r in ratio)])
            print(" ".join(rows[-1]), flush=True)
            ratios.append((shape.name, depth, ratio[0]))
    head = ("model", "cells", "plane s", "+ Clean Up", "sharp", "+ Clean Up", "wall", "CPU")
    report.table(
        f"{options.threads} threads, seconds and sharp+clean / plane", head, rows, "seconds"
    )
    for name, depth, ratio in ratios:
        report.verdict(
            ratio <= BAR, f"{name}, depth {depth}: {ratio:.2f} times plane; {BAR} is allowed"
        )
    report.finish(options.json)


if __name__ == "__main__":
    main()
