# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxelizes every mesh of a folder as the add-on does, and lets others judge the results.

Usage: scripts/run python3 bench/voxels/gathered.py FOLDER [--depth N] [--interpolant NAME]
    [--only TEXT] [--limit SECONDS] [--jobs N] [--keep FOLDER] [--json FILE]

Meshes are read by trimesh (PyPI): STL, OBJ, PLY, OFF and glTF, sound or broken; each
folder in FOLDER is a kind of meshes. Each is made a solid, voxelized with the minimum thickness,
contoured and cleaned up with the add-on's defaults, in a process of its own that has --limit
seconds. Judges are CGAL's exact predicates (the program of self_intersections.cpp) and libigl
(PyPI): squared distances, and generalized winding numbers. Lengths are in cells.

The columns of a mesh: triangles of the mesh; triangles of the result; open, crowded and pinched
places; pairs of triangles that cut each other; folds, edges that turn by over 120 degrees, except
wedges; strays, folds with a triangle that does not lie along the source, by 0.1 of a cell and 20
degrees; wedges, such edges within a quarter of a cell of a source edge that turns as far itself,
to the same side, as where a cap or another part meets the mesh at an acute
angle; wedges at caps of holes; distances of samples of the result from the mesh, median, 95th
percentile and largest; the share of the mesh, in percent, that is more than a cell from the result
and outside of it; parts and genus of the result, and of the mesh where it is closed; processor
seconds. Totals count meshes; distances and seconds in them are medians over meshes, and the most
seconds.
"""

import argparse
import concurrent.futures
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
from bench.voxels import measures, wedges

ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb")
SAMPLES = 20_000
GAP, THICKNESS = 2.0, 1.5  # The add-on's defaults.
ALONG = 0.1  # Cells,
ALONG_DEGREES = 20.0  # and degrees.
MISSING = 1.0  # Cells: parts farther outside the result are missing.
HEAD = (
    "mesh",
    "triangles",
    "result",
    "unsound",
    "cuts",
    "folds",
    "stray",
    "wedges",
    "at caps",
    "off",
    "off 95 %",
    "farthest",
    "missing %",
    "parts",
    "genus",
    "s",
)
TOTALS = (
    "meshes",
    "number",
    "without a result",
    "closed",
    "2-manifold",
    "cut themselves",
    "fold",
    "stray",
    "off",
    "off 95 %",
    "s",
    "s, most",
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
) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray, int], float, float]:
    """Returns the surface that the add-on makes, the cell, and processor seconds.

    Before the cell come the source's positions and triangles, and the number of these that are no
    caps of holes.
    """
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
    solid_mesh = closed.positions, closed.triangles, len(solid.triangles)
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
    """Distances of points from a surface."""
    import igl

    return np.sqrt(
        igl.point_mesh_squared_distance(points, positions, triangles.astype(np.int64))[0]
    )


def at_caps(
    made: np.ndarray, pairs: np.ndarray, positions: np.ndarray, triangles: np.ndarray, uncapped: int
) -> int:
    """Counts pairs (n, 2, 3) of triangles, one of which is nearest to a cap."""
    import igl

    if not len(pairs):
        return 0
    middles = made[pairs.reshape(-1, 3)].mean(axis=1)
    _, nearest, _ = igl.point_mesh_squared_distance(middles, positions, triangles.astype(np.int64))
    return int((nearest.reshape(-1, 2) >= uncapped).any(axis=1).sum())


def strays(
    made: np.ndarray, pairs: np.ndarray, positions: np.ndarray, triangles: np.ndarray, cell: float
) -> int:
    """Counts pairs (n, 2, 3) of triangles that do not both lie along a mesh."""
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
    is_along = (far < ALONG) & (cosines > np.cos(np.radians(ALONG_DEGREES)))
    return int((~is_along.reshape(-1, 2).all(axis=1)).sum())


def measured(path: Path, depth: int, interpolant: str) -> dict[str, object]:
    """Returns the measurements of one mesh."""
    positions, triangles = read(path)
    found: dict[str, object] = {"triangles": len(triangles)}
    used = positions[np.unique(triangles)]
    middle, size = (used.min(axis=0) + used.max(axis=0)) / 2, np.ptp(used, axis=0).max()
    positions = (positions - middle) * (2 / size)
    made, faces, solid, cell, found["seconds"] = voxelized(positions, triangles, depth, interpolant)
    found["result"] = len(faces)
    sound = measures.soundness(made, faces)
    found["open"] = sound.open_edges
    found["unsound"] = sound.open_edges + sound.crowded_edges + sound.crowded_vertices
    found["cuts"] = sound.intersections
    turned = measures.folded_pairs(made, faces)
    is_wedge = wedges.are_wedges(made, faces, turned, solid[:2], cell)
    found["folds"], found["wedges"] = int((~is_wedge).sum()), int(is_wedge.sum())
    found["stray"] = strays(made, faces[turned[~is_wedge]], *solid[:2], cell)
    found["at caps"] = at_caps(made, faces[turned[is_wedge]], *solid)
    own, _ = measures.surface_samples(made, faces, SAMPLES)
    off = distances(own, positions, triangles) / cell
    found["off"], found["off 95 %"] = np.quantile(off, (0.5, 0.95)).tolist()
    found["farthest"] = float(off.max())
    points, _ = measures.surface_samples(positions, triangles, SAMPLES)
    far = distances(points, made, faces) > MISSING * cell
    found["missing"] = 100 * missing(points, far, made, faces)
    found["parts"], found["genus"] = measures.topology(faces)
    is_closed = measures.manifoldness(triangles, len(positions)).open_edges == 0
    if is_closed:
        found["own parts"], found["own genus"] = measures.topology(triangles)
    return found


def of_another_process(path: Path, options: argparse.Namespace) -> dict[str, object] | str:
    """Returns the measurements of one mesh, kept or new, or the reason for their absence."""
    kept = options.keep and options.keep / f"{path.parent.name} {path.name}.json"
    if kept and kept.exists():
        return json.loads(kept.read_text())
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
    # File readers print, too.
    line = done.stdout.splitlines()[-1]
    if kept:
        kept.write_text(line)
    return json.loads(line)


def row(name: str, found: dict[str, object]) -> list[str]:
    """The columns of a table's row."""

    def beside(what: str) -> str:
        own = found.get(f"own {what}")
        return f"{found[what]}" if own is None else f"{found[what]} of {own}"

    return [
        name,
        *(str(found[key]) for key in ("triangles", "result", "unsound", "cuts")),
        *(str(found[key]) for key in ("folds", "stray", "wedges", "at caps")),
        *(f"{found[key]:.2f}" for key in ("off", "off 95 %", "farthest", "missing")),
        beside("parts"),
        beside("genus"),
        f"{found['seconds']:.1f}",
    ]


def total(kind: str, all_found: list[dict[str, object]], refused: int) -> list[str]:
    """A row of the totals."""

    def count(key: str, *, is_zero: bool = False) -> str:
        return str(sum((found[key] == 0) == is_zero for found in all_found))

    def median(key: str) -> float:
        return float(np.median([found[key] for found in all_found]))

    return [
        kind,
        str(len(all_found) + refused),
        str(refused),
        count("open", is_zero=True),
        count("unsound", is_zero=True),
        *(count(key) for key in ("cuts", "folds", "stray")),
        f"{median('off'):.3f}",
        f"{median('off 95 %'):.3f}",
        f"{median('seconds'):.2f}",
        f"{max(found['seconds'] for found in all_found):.1f}",
    ]


def totals(kinds: list[str], results: list[dict[str, object] | str]) -> list[list[str]]:
    """The rows of the totals: of each kind, and of all."""
    rows = []
    for kind in [*dict.fromkeys(kinds), "all"]:
        own = [found for k, found in zip(kinds, results, strict=True) if kind in (k, "all")]
        all_found = [found for found in own if isinstance(found, dict)]
        if all_found:
            rows.append(total(kind, all_found, len(own) - len(all_found)))
    return rows


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--depth", type=int, default=7)
    parser.add_argument("--interpolant", default="sharp")
    parser.add_argument("--only", default="", help="part of the names")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds that a mesh has")
    parser.add_argument("--jobs", type=int, default=1, help="meshes at a time")
    parser.add_argument("--keep", type=Path, help="folder that keeps results, to resume a run")
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
    paths = [
        p
        for p in sorted(options.folder.rglob("*"))
        if p.suffix.lower() in ENDINGS and options.only in p.name
    ]
    results = []
    print("  ".join(HEAD))
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for path, found in zip(
            paths, pool.map(lambda p: of_another_process(p, options), paths), strict=True
        ):
            results.append(found)
            shown = [path.name, found] if isinstance(found, str) else row(path.name, found)
            print("  ".join(shown), flush=True)
    report_all(report, paths, results, options.depth)
    report.finish(options.json)


def report_all(
    report: Report, paths: list[Path], results: list[dict[str, object] | str], depth: int
) -> None:
    """Adds the tables and verdicts."""
    named = list(zip(paths, results, strict=True))
    rows = [row(path.name, found) for path, found in named if isinstance(found, dict)]
    refused = [(path.name, found) for path, found in named if isinstance(found, str)]
    all_found = [found for found in results if isinstance(found, dict)]
    is_over = [any(found[key] for key in ("unsound", "cuts", "folds")) for found in all_found]
    over = [r for r, is_one in zip(rows, is_over, strict=True) if is_one]
    cells = f"{2**depth} cells along an axis"
    report.table(cells, TOTALS, totals([p.parent.name for p in paths], results), "totals")
    if over:
        report.table(f"{cells}, unsound or folded", HEAD, over, "over")
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


if __name__ == "__main__":
    main()
