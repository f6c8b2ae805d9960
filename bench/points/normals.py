# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares normals of points with the true ones: which side they are on, their angle, the time.

Usage: scripts/run python3 bench/points/normals.py [MODEL...] [--points N] [--neighbors N]
                                                  [--noise CELLS...] [--rounds N] [--json FILE]

Points are drawn evenly from meshes, and moved by noise in cells of an octree of depth 9 around
them, normally distributed along each axis. Without names it is all models but fandisk.
PREFILTER_OPEN3D_PYTHON is a Python that can import open3d, where ours cannot; without any, it is
left out. Each library has one thread and one processor, and orients by propagation.
"""

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers.point_normals import LIBRARIES, PointNormals
from bench.points.sets import DEPTH, Model, cell_of
from bench.report import Report, add_json_option
from bench.turns import measure, named
from bench.voxels.meshes import DATA

MODELS = {
    "igea": "igea_tri.ply",
    "armadillo": "armadillo.obj",
    "bunny": "stanford-bunny.obj",
    "rocker-arm": "rocker-arm.obj",
    "fandisk": "fandisk.obj",
    "dragon": "dragon_vrip_res3.ply",
    "suzanne": "suzanne.obj",
}
SLOW = "fandisk"  # Its flat faces, without noise, take Open3D minutes.
HEAD = ("model", "noise, cells", "library", "wrong side, %", "angle, degrees", "CPU s")


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    chosen = [name for name in MODELS if name != SLOW]
    parser.add_argument("models", nargs="*", default=chosen, metavar="MODEL")
    parser.add_argument("--points", type=int, default=100_000, help="default: %(default)s")
    parser.add_argument("--neighbors", type=int, default=16, help="default: %(default)s")
    parser.add_argument("--noise", type=float, nargs="+", default=[0.0, 0.5, 1.5])
    parser.add_argument("--rounds", type=int, default=1, help="default: %(default)s")
    add_json_option(parser)
    options = parser.parse_args()
    for name in options.models:
        if name not in MODELS:
            parser.error(f"no model is called '{name}'; there are {', '.join(MODELS)}")
    report = Report()
    libraries = list(LIBRARIES)
    if missing := PointNormals.missing():
        report.note(f"Open3D is left out: it needs {missing}")
        libraries.remove("open3d")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in options.models:
            model = Model.read(DATA / MODELS[name])
            for noise in options.noise:
                random = np.random.default_rng(0)
                points, normals = model.draw(options.points, random)
                points = points + noise * cell_of(points, DEPTH) * random.normal(size=points.shape)
                for library, cells in compare(
                    Path(folder), libraries, points, normals, options.neighbors, options.rounds
                ).items():
                    rows.append([name, f"{noise:g}", library, *cells])
    title = f"{options.points} points, {options.neighbors} neighbors"
    report.table(title, HEAD, rows, "normals")
    report.finish(options.json)


def compare(
    folder: Path,
    libraries: list[str],
    points: NDArray[np.float64],
    normals: NDArray[np.float32],
    neighbors: int,
    rounds: int,
) -> dict[str, list[str]]:
    """Returns the cells of each library's row."""
    source = folder / "points.npy"
    np.save(source, points)
    targets = {library: folder / f"{library}.npy" for library in libraries}
    peers = [PointNormals(name, source, target, neighbors) for name, target in targets.items()]
    runs = measure(named(*peers), rounds, uncounted=0)
    cells = {}
    for library, target in targets.items():
        cosines = np.sum(np.load(target) * normals, axis=1)
        # Which side is outside is one guess; it counts for all points or for none.
        wrong = min(np.mean(cosines <= 0), np.mean(cosines >= 0))
        angle = np.degrees(np.arccos(np.clip(np.abs(cosines), 0, 1))).mean()
        seconds = statistics.median(run.cpu_seconds for run in runs[library])
        cells[library] = [f"{100 * wrong:.3f}", f"{angle:.2f}", f"{seconds:.2f}"]
    return cells


if __name__ == "__main__":
    main()
