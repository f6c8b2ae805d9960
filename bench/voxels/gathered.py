# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxelizes every mesh of a folder as the add-on does, and lets others judge the results.

Usage: scripts/run python3 bench/voxels/gathered.py FOLDER [--depth N] [--interpolant NAME]
    [--only TEXT] [--limit SECONDS] [--json FILE]

Meshes are read by trimesh (PyPI): STL, OBJ, PLY, OFF and glTF, of any kind, sound or broken. Each
is made a solid, voxelized with the minimum thickness, contoured and cleaned up with the add-on's
defaults, in a process of its own that has --limit seconds. Judges are CGAL's exact predicates (the
program of self_intersections.cpp) and libigl (PyPI): squared distances, and generalized winding
numbers. Lengths are in cells.

The columns: triangles of the mesh; triangles of the result; open, crowded and pinched places; pairs
of triangles that cut each other; edges that turn by over 120 degrees where none of the mesh's does
so within a cell; strays, those of them with a triangle that does not lie along what is voxelized,
by 0.1 of a cell and 20 degrees (where closed holes, or parts that cross, meet the mesh in a wedge or
a crevice there is no edge of the mesh, but no fold either); how far samples of the
result are from the mesh, 95th percentile and farthest; the share of the mesh, in percent, that is
more than a cell from the result and outside of it; parts and genus of the result, and of the mesh
where it is closed; processor seconds.
"""

import argparse
import importlib.util
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.voxels import measures

ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb")
SAMPLES = 20_000
GAP, THICKNESS = 2.0, 1.5  # As the add-on has them.
WEDGES_LESS = 20.0  # Degrees, as measures.folds allows.
ALONG = 0.1  # Cells.
MISSING = 1.0  # Of a cell: what is farther from the result, and outside of it, is missing.
HEAD = (
    "mesh",
    "triangles",
    "result",
    "unsound",
    "cuts",
    "folds",
    "stray",
    "off 95 %",
    "farthest",
    "missing %",
    "parts",
    "genus",
    "s",
)


def read(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Returns the positions and triangles of all that a file shows; of STL, corners welded."""
    import trimesh

    mesh = trimesh.load(path, force="mesh", process=False)
    positions = np.asarray(mesh.vertices, np.float64)
    triangles = np.asarray(mesh.faces, np.int64)
    if path.suffix.lower() == ".stl":
        positions, names = np.unique(positions, axis=0, return_inverse=True)
        triangles = names.reshape(-1)[triangles]
    return positions, triangles


def voxelized(
    positions: np.ndarray, triangles: np.ndarray, depth: int, interpolant: str
) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray], float, float]:
    """Returns the surface that the add-on makes, and of what; the cell, and processor seconds."""
    import prefilter

    started = time.process_time()
    low, high = positions.min(axis=0), positions.max(axis=0)
    bounds = prefilter.cube_around((low, high), depth=depth)
    cell = (np.asarray(bounds[1]) - np.asarray(bounds[0])).max() / 2**depth
    solid = prefilter.as_solid(
        positions, triangles, cell=cell, gap=GAP, thickness=THICKNESS, sheets="faces"
    )
    closed = prefilter.close_holes(solid.positions, solid.triangles, method="smooth")
    tree = prefilter.voxelize(
        closed.positions, closed.triangles, depth=depth, bounds=bounds, thickness=THICKNESS
    )
    sources = {"sources": [(closed.positions, closed.triangles)]} if interpolant == "sharp" else {}
    made = tree.contour(interpolant=interpolant, cleanup=True, **sources)
    taken = time.process_time() - started
    solid_mesh = closed.positions, closed.triangles
    return made[0], made[1].astype(np.int64), solid_mesh, float(cell), taken


def missing(
    points: np.ndarray, far: np.ndarray, positions: np.ndarray, triangles: np.ndarray
) -> float:
    """The share of points that are far from a surface, and outside of it."""
    import igl

    chosen = points[far]
    if not len(chosen):
        return 0.0
    inside = igl.fast_winding_number(positions, triangles.astype(np.int64), chosen)
    return float((inside < 0.5).sum() / len(points))


def distances(points: np.ndarray, positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """How far points are from a surface."""
    import igl

    return np.sqrt(
        igl.point_mesh_squared_distance(points, positions, triangles.astype(np.int64))[0]
    )


def strays(
    made: np.ndarray, pairs: np.ndarray, positions: np.ndarray, triangles: np.ndarray, cell: float
) -> int:
    """How many pairs (n, 2, 3) of triangles do not both lie along a mesh."""
    import igl

    if not len(pairs):
        return 0
    corners = made[pairs.reshape(-1, 3)]
    middles = corners.mean(axis=1, keepdims=True)
    points = np.concatenate([middles, (corners + middles) / 2], axis=1).reshape(-1, 3)
    squares, nearest, _ = igl.point_mesh_squared_distance(
        points, positions, triangles.astype(np.int64)
    )
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    own = measures.facet_normals(positions, triangles)[0][nearest].reshape(-1, 4, 3)
    cosines = np.abs((own * normals[:, None]).sum(axis=2)).min(axis=1)
    far = np.sqrt(squares).reshape(-1, 4).max(axis=1) / cell
    is_along = (far < ALONG) & (cosines > np.cos(np.radians(WEDGES_LESS)))
    return int((~is_along.reshape(-1, 2).all(axis=1)).sum())


def measured(path: Path, depth: int, interpolant: str) -> dict[str, object]:
    """What is found of one mesh."""
    positions, triangles = read(path)
    found: dict[str, object] = {"triangles": len(triangles)}
    used = positions[np.unique(triangles)]
    middle, size = (used.min(axis=0) + used.max(axis=0)) / 2, np.ptp(used, axis=0).max()
    positions = (positions - middle) * (2 / size)
    made, faces, solid, cell, found["seconds"] = voxelized(positions, triangles, depth, interpolant)
    found["result"] = len(faces)
    sound = measures.soundness(made, faces)
    found["unsound"] = sound.open_edges + sound.crowded_edges + sound.crowded_vertices
    found["cuts"] = sound.intersections
    wedges = measures.sharp_edges(positions, triangles, measures.FOLD - WEDGES_LESS)
    folded = measures.folded_pairs(made, faces, measures.FOLD, wedges, cell)
    found["folds"] = len(folded)
    found["stray"] = strays(made, faces[folded], *solid, cell)
    own, _ = measures.surface_samples(made, faces, SAMPLES)
    off = distances(own, positions, triangles) / cell
    found["off"], found["farthest"] = float(np.quantile(off, 0.95)), float(off.max())
    points, _ = measures.surface_samples(positions, triangles, SAMPLES)
    far = distances(points, made, faces) > MISSING * cell
    found["missing"] = 100 * missing(points, far, made, faces)
    found["parts"], found["genus"] = measures.topology(faces)
    is_closed = measures.manifoldness(triangles, len(positions)).open_edges == 0
    if is_closed:
        found["own parts"], found["own genus"] = measures.topology(triangles)
    return found


def of_another_process(path: Path, options: argparse.Namespace) -> dict[str, object] | str:
    """What is found of one mesh, or why there is nothing."""
    command = [sys.executable, __file__, "--one", str(path)]
    command += ["--depth", str(options.depth), "--interpolant", options.interpolant]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=options.limit, env=os.environ
        )
    except subprocess.TimeoutExpired:
        return f"not done in {options.limit:g} s"
    if done.returncode:
        return (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]
    # Readers of files print, too.
    return json.loads(done.stdout.splitlines()[-1])


def row(name: str, found: dict[str, object]) -> list[str]:
    """The columns of a table's row."""

    def beside(what: str) -> str:
        own = found.get(f"own {what}")
        return f"{found[what]}" if own is None else f"{found[what]} of {own}"

    return [
        name,
        *(str(found[key]) for key in ("triangles", "result", "unsound", "cuts", "folds", "stray")),
        *(f"{found[key]:.2f}" for key in ("off", "farthest", "missing")),
        beside("parts"),
        beside("genus"),
        f"{found['seconds']:.1f}",
    ]


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--depth", type=int, default=7)
    parser.add_argument("--interpolant", default="sharp")
    parser.add_argument("--only", default="", help="part of the names")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds that a mesh has")
    parser.add_argument("--one", type=Path, help=argparse.SUPPRESS)
    add_json_option(parser)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(measured(options.one, options.depth, options.interpolant)))
        return
    for module in ("trimesh", "igl"):
        if importlib.util.find_spec(module) is None:
            sys.exit(f"needs {module} (PyPI)")
    report = Report()
    rows, all_found, refused = [], [], []
    paths = [p for p in sorted(options.folder.iterdir()) if p.suffix.lower() in ENDINGS]
    for path in paths:
        if options.only not in path.name:
            continue
        found = of_another_process(path, options)
        if isinstance(found, str):
            refused.append((path.name, found))
            print(f"{path.name}: {found}", flush=True)
            continue
        rows.append(row(path.name, found))
        all_found.append(found)
        print("  ".join(rows[-1]), flush=True)
    report.table(f"{2**options.depth} cells along an axis", HEAD, rows, "meshes")
    if refused:
        report.table("Without a result", ("mesh", "why"), refused, "refused")
    for key, text in (
        ("unsound", "are not closed and 2-manifold"),
        ("cuts", "cut themselves"),
        ("folds", "have an edge that turns by over 120 degrees"),
        ("stray", "have such an edge with a triangle that does not lie along what is voxelized"),
    ):
        wrong = sum(1 for found in all_found if found[key])
        report.verdict(wrong == 0, f"of {len(all_found)} results {wrong} {text}")
    report.finish(options.json)


if __name__ == "__main__":
    main()
