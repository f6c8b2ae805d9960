# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of surfaces: closed and manifold, without intersections, near their sources."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.field import polygons, shapes
from bench.points import ply
from bench.voxels import measures

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

MAX_FOLD_DEGREES = 120.0
VOXELIZE_CELLS = 254.0
"""Cells along the longest side at the operator's default depth, 8, less a cell at both ends."""
MAX_CELLS_OFF = 1.5
SAMPLES = 20_000
HIGH_QUANTILE = 0.999
MAX_RESULT_TRIANGLES = 400_000
"""Results of more triangles get no search for intersections, which would take minutes."""


def check_solid(run: Any, truth: Mapping[str, Any]) -> list[str]:
    """Checks a result of Voxelize against its source mesh."""
    mesh = ply.read_mesh(run.target)
    positions, triangles = np.asarray(mesh.positions, float), np.asarray(mesh.triangles)
    if not len(triangles):
        return ["empty: the result has no triangles"]
    findings = _check_soundness(positions, triangles, must_be_closed=True)
    if (source := _source_mesh(run.source)) is None:
        return findings
    cell = np.ptp(source[0][np.unique(source[1])], axis=0).max() / VOXELIZE_CELLS
    folds = measures.folds(
        positions,
        triangles,
        MAX_FOLD_DEGREES,
        measures.sharp_edges(*source, MAX_FOLD_DEGREES - 20),
        2 * cell,
    )
    if folds:
        findings.append(f"folds: {folds} edges beyond the source's")
    findings += _check_distances((positions, triangles), source, cell)
    if truth.get("closed"):
        findings += _check_topology(triangles, truth)
        findings += _check_volume(positions, triangles, truth)
    return findings


def check_scan(run: Any, truth: Mapping[str, Any]) -> list[str]:
    """Checks a result of Reconstruct Surface against the points, or the sampled shape."""
    mesh = ply.read_mesh(run.target)
    positions, triangles = np.asarray(mesh.positions, float), np.asarray(mesh.triangles)
    if not len(triangles):
        return ["empty: the result has no triangles"]
    findings = _check_soundness(positions, triangles, must_be_closed=False)
    # Survey coordinates do not fit the single precision of Blender's importer; a warning says so.
    if "shape" not in truth or "coordinates were rounded" in run.output:
        return findings
    shape = shapes.Shape.of(truth["shape"])
    spacing = truth["spacing"]
    samples, faces = measures.surface_samples(positions, triangles, SAMPLES)
    high = np.quantile(shape.distances(samples), HIGH_QUANTILE)
    if high > 4 * spacing + truth.get("noise", 0.0) * 4:
        findings.append(f"invented: 0.1 % of the surface is over {high / spacing:.1f} spacings off")
    normals, _ = measures.facet_normals(positions, triangles)
    facing = (normals[faces] * shape.outward(samples)).sum(axis=1) > 0
    if (share := facing.mean()) < 0.9:
        findings.append(f"inside out: {100 * share:.0f} % of the surface faces outward")
    return findings


def _check_soundness(positions: Floats, triangles: Indices, *, must_be_closed: bool) -> list[str]:
    findings = []
    if not np.isfinite(positions).all():
        return ["not finite: a position is NaN or infinite"]
    found = measures.manifoldness(triangles, len(positions))
    if must_be_closed and found.open_edges:
        findings.append(f"open: {found.open_edges} edges")
    if found.crowded_edges or found.crowded_vertices:
        findings.append(
            f"not manifold: {found.crowded_edges} edges and {found.crowded_vertices} vertices"
        )
    if len(triangles) <= MAX_RESULT_TRIANGLES:
        pairs = _intersecting_pairs(positions, triangles)
        if pairs:
            findings.append(f"intersections: {pairs} pairs of triangles")
    return findings


def _intersecting_pairs(positions: Floats, triangles: Indices) -> int:
    """Counts by CGAL where its program was built, else by the library's own exact test."""
    import prefilter

    if measures.checker():
        return measures.self_intersections(positions, triangles)[0]
    return len(prefilter.self_intersections(positions, triangles))


def _source_mesh(path: Path) -> tuple[Floats, Indices] | None:
    """Returns the triangles of a file; None if it is unreadable, or holds none.

    trimesh reads triangle files; it would cut polygons as fans, convex or not.
    """
    import trimesh

    try:
        if path.suffix.lower() == ".obj":
            positions, triangles = polygons.read_obj(path)
        elif (read := polygons.read_ascii_ply(path)) is not None:
            positions, triangles = read
        else:
            mesh = trimesh.load(path, force="mesh", process=False)
            positions, triangles = np.asarray(mesh.vertices, float), np.asarray(mesh.faces)
    except Exception:  # Whatever another library raises for a damaged file.
        return None
    if not len(triangles) or not np.isfinite(positions).all():
        return None
    positions, numbers = np.unique(positions, axis=0, return_inverse=True)
    triangles = numbers.reshape(-1)[triangles]
    _, areas = measures.facet_normals(positions, triangles)
    triangles = triangles[areas > 0]
    return (positions, triangles) if len(triangles) else None


def _check_distances(
    result: tuple[Floats, Indices], source: tuple[Floats, Indices], cell: float
) -> list[str]:
    findings = []
    points, _ = measures.surface_samples(*source, SAMPLES)
    lost = _distances(points, *result) / cell
    # Parts of the source inside the result are not lost: they are inner faces.
    is_far = lost > MAX_CELLS_OFF
    if is_far.mean() > 1 - HIGH_QUANTILE:
        outside = ~_inside(points[is_far][:200], *result)
        share = is_far.mean() * outside.mean()
        if share > 1 - HIGH_QUANTILE:
            findings.append(
                f"missing: {100 * share:.1f} % of the source, by up to {lost.max():.1f} cells"
            )
    is_closed = measures.manifoldness(source[1], len(source[0])).open_edges == 0
    if is_closed:
        points, _ = measures.surface_samples(*result, SAMPLES)
        high = np.quantile(_distances(points, *source) / cell, HIGH_QUANTILE)
        if high > MAX_CELLS_OFF:
            findings.append(f"invented: 0.1 % of the result is over {high:.1f} cells off")
    return findings


def _distances(points: Floats, positions: Floats, triangles: Indices) -> Floats:
    import prefilter

    nearest, _, distances = prefilter.nearest_points(points, positions, triangles)
    del nearest
    return np.asarray(distances, float)


def _inside(points: Floats, positions: Floats, triangles: Indices) -> NDArray[np.bool_]:
    """Tells which points a closed surface encloses: its solid angle, seen from each, is 4 pi."""
    corners = positions[triangles]
    inside = np.zeros(len(points), bool)
    for number, point in enumerate(points):
        a, b, c = np.moveaxis(corners - point, 1, 0)
        lengths = [np.linalg.norm(side, axis=1) for side in (a, b, c)]
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        divisor = (
            lengths[0] * lengths[1] * lengths[2]
            + (a * b).sum(axis=1) * lengths[2]
            + (b * c).sum(axis=1) * lengths[0]
            + (c * a).sum(axis=1) * lengths[1]
        )
        inside[number] = abs(np.arctan2(volume, divisor).sum()) > np.pi
    return inside


def _check_topology(triangles: Indices, truth: Mapping[str, Any]) -> list[str]:
    parts, genus = measures.topology(triangles)
    if (parts, genus) == (truth["parts"], truth["genus"]):
        return []
    return [
        f"topology: {parts} parts of genus {genus}; {truth['parts']} of genus {truth['genus']} "
        "are right"
    ]


def _check_volume(positions: Floats, triangles: Indices, truth: Mapping[str, Any]) -> list[str]:
    corners = positions[triangles] - positions.mean(axis=0)
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    if abs(volume / truth["volume"] - 1) <= truth.get("volume_tolerance", 0.02):
        return []
    return [f"volume: {volume:.4g}; {truth['volume']:.4g} is right"]
