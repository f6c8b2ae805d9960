# SPDX-License-Identifier: GPL-3.0-or-later

"""Takes the measures of edges.py of Blender's Remesh and of its EXACT boolean.

Usage: scripts/run python3 bench/voxels/edge_peers.py [--shapes NAME...] [--pairs NAME+NAME...]
    [--sizes N...] [--keep FOLDER]

Remesh gets the cells that contours get: of their octree for Sharp and Smooth, as voxels for Voxel.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers import blender_meshes
from bench.report import Report
from bench.voxels import edges
from bench.voxels.sharp_shapes import Shape

BOOLEANS = {"union": "UNION", "intersection": "INTERSECT", "difference": "DIFFERENCE"}


def saved(folder: Path, shape: Shape, name: str) -> str:
    """Writes a mesh; returns the file."""
    path = folder / f"{name}.npz"
    np.savez(path, positions=shape.positions, triangles=shape.triangles)
    return str(path)


def jobs_of(
    folder: Path, subject: edges.Subject, size: int
) -> list[tuple[str, blender_meshes.Job]]:
    """Returns Blender's jobs for a subject, by name."""
    name = subject.name.replace(" ", "_")
    _, cell = edges.box_around(subject.sources, size)
    sources = tuple(
        saved(folder, source, f"{name}_{size}_{k}") for k, source in enumerate(subject.sources)
    )
    if subject.operation:
        target = str(folder / f"{name}_{size}_EXACT.npz")
        made = blender_meshes.Job(sources, target, BOOLEANS[subject.operation])
        return [("Blender EXACT", made)]
    found = []
    for mode in blender_meshes.REMESH_MODES:
        target = str(folder / f"{name}_{size}_{mode}.npz")
        scale = 1 - 2 * edges.MARGIN / size
        made = blender_meshes.Job(
            sources, target, mode, depth=size.bit_length() - 1, scale=scale, cell=cell
        )
        found.append((f"Blender Remesh {mode.capitalize()}", made))
    return found


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    edges.add_subjects(parser)
    parser.add_argument("--keep", type=Path, help="a folder for the meshes")
    options = parser.parse_args()
    if blender_meshes.missing():
        raise SystemExit(f"{blender_meshes.missing()} is missing")
    report = Report()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for size in options.sizes:
            rows = []
            for subject in edges.subjects_of(options):
                jobs = jobs_of(folder, subject, size)
                blender_meshes.run_jobs([job for _, job in jobs])
                _, cell = edges.box_around(subject.sources, size)
                for name, job in jobs:
                    made = np.load(job.target)
                    if not len(made["triangles"]):
                        rows.append([subject.name, name, *["-"] * (len(edges.HEAD) - 2)])
                        continue
                    found = edges.measured(
                        subject, made["positions"], made["triangles"], cell, float(made["seconds"])
                    )
                    rows.append([subject.name, name, *found.row])
                    print(" ".join(rows[-1]), flush=True)
            report.table(f"{size} cells along an axis", edges.HEAD, rows)
    report.finish(options.json)


if __name__ == "__main__":
    main()
