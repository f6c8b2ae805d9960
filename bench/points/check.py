# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks the basis of the figures: distances, the test for closedness, and the sets' properties.

Usage: scripts/run python3 -m bench.points.check

Distances are compared with brute force over all triangles. Ends with status 1 where a check fails.
"""

import tempfile
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray

from bench.points import hard_sets, ply, scans, sets, soundness
from bench.points.measure import manifold_kind
from bench.report import Report
from bench.voxels.meshes import DATA, Triangles

MODEL = DATA / "rocker-arm.obj"
BUNNY = sets.SHARED / "points/bunny/bun.conf"
TETRAHEDRON = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
Floats = NDArray[np.float64]


def main() -> None:
    """Checks and prints."""
    report = Report()
    random = np.random.default_rng(7)
    check_manifolds(report)
    check_soundness(report)
    if MODEL.exists():
        model = sets.Model.read(MODEL)
        check_distances(report, model, random)
        check_sets(report, model, random)
    if BUNNY.exists():
        check_scans(report, BUNNY)
    report.finish(None)


def check_manifolds(report: Report) -> None:
    """Checks `is_closed` and `is_manifold` on known meshes."""
    touching = np.concatenate([TETRAHEDRON, np.where(TETRAHEDRON == 0, 0, TETRAHEDRON + 3)])
    flipped = np.concatenate([TETRAHEDRON[:3], TETRAHEDRON[3:, ::-1]])
    known = {
        "a tetrahedron": (TETRAHEDRON, (True, True)),
        "two that share a corner": (touching, (True, False)),
        "one without a face": (TETRAHEDRON[:3], (False, False)),
        "one with a face turned over": (flipped, (False, False)),
        "one twice": (np.concatenate([TETRAHEDRON, TETRAHEDRON]), (False, False)),
    }
    for name, (triangles, kind) in known.items():
        found = manifold_kind(Triangles(np.zeros((triangles.max() + 1, 3)), triangles))
        report.verdict(found == kind, f"{name}: closed {found[0]}, 2-manifold {found[1]}")


def check_soundness(report: Report) -> None:
    """A box, and one that lacks a side and has a sheet far away instead."""
    whole = hard_sets.box((0, 0, 0), (1, 1, 1))
    sheet = Triangles(np.array([(5.0, 0, 0), (5, 1, 0), (5, 0, 1)]), np.array([(0, 1, 2)]))
    torn = hard_sets.joined([Triangles(whole.positions, whole.triangles[2:]), sheet])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        points, normals = sets.Model.of(whole).draw(20_000, np.random.default_rng(1))
        ply.write_points(folder / "points.ply", len(points), [(points, normals)])
        for file, mesh in (("whole.ply", whole), ("torn.ply", torn)):
            ply.write_mesh(folder / file, mesh.positions, mesh.triangles)
        for truth in (folder / "whole.ply", None):
            beside = "points" if truth is None else "the truth"
            arguments = (truth, 0.01, folder / "points.ply", 20_000)
            same = soundness.soundness(folder / "whole.ply", *arguments)
            kind = (same.parts, same.genus, same.folded, same.lost, same.invented)
            report.verdict(kind == (1, 0, 0, 0, 0), f"a box beside {beside}: {kind}")
            report.verdict(same.degrees < 0.01, f"its normals are {same.degrees:.3f} degrees off")
            other = soundness.soundness(folder / "torn.ply", *arguments)
            report.verdict(
                (other.parts, other.genus) == (2, -1)
                and abs(other.lost - 100 / 6 * 0.94**2) < 1
                and abs(other.invented - 100 / 11) < 1,
                f"torn, beside {beside}: {other.lost:.1f} % lost, {other.invented:.1f} % invented",
            )


def check_distances(report: Report, model: sets.Model, random: np.random.Generator) -> None:
    """Points near the surface and far from it."""
    points, _ = model.draw(400, random)
    size = np.ptp(points, axis=0).max()
    points += size * random.normal(size=points.shape) * 10 ** random.uniform(-4, 0, (400, 1))
    mesh = model.mesh
    _, _, found = prefilter.nearest_points(points, mesh.positions, mesh.triangles)
    wanted = np.array([brute_force(point, mesh.corners) for point in points])
    error = np.abs(found - wanted).max() / size
    report.verdict(error < 1e-12, f"distances differ from brute force by {error:.1e} of the size")


def brute_force(point: Floats, corners: Floats) -> float:
    """The distance of a point from triangles (m, 3, 3): from the plane, else from an edge."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    within = lengths > 0
    best = np.inf
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        squared = np.maximum((along**2).sum(axis=1), 1e-300)
        share = np.clip(((point - start) * along).sum(axis=1) / squared, 0, 1)
        best = min(best, np.linalg.norm(point - start - share[:, None] * along, axis=1).min())
        within &= (np.cross(along, point - start) * normals).sum(axis=1) >= 0
    heights = np.abs(((point - a) * normals).sum(axis=1))[within] / lengths[within]
    return float(min(best, heights.min(initial=np.inf)))


def check_sets(report: Report, model: sets.Model, random: np.random.Generator) -> None:
    """Checks the sampling, noise and other changes applied to the points."""
    points, normals = cloud = model.draw(100_000, random)
    shares = np.bincount(
        prefilter.nearest_points(points, model.mesh.positions, model.mesh.triangles)[0],
        minlength=len(model.normals),
    ) / len(points)  # fmt: skip
    areas = np.diff(model.sums, prepend=0) / model.sums[-1]
    spread = float(((shares - areas) ** 2 / np.maximum(areas, 1e-12)).sum() * len(points))
    freedom = np.count_nonzero(areas)
    report.verdict(
        abs(spread / freedom - 1) < 0.1,
        f"points spread by area: chi squared / degrees of freedom {spread / freedom:.3f}",
    )
    cell = sets.cell_of(points, sets.DEPTH)
    moved = sets.noisy(cloud, random)[0] - points
    report.verdict(
        abs(moved.std() / cell / sets.NOISE - 1) < 0.01,
        f"noise: {moved.std() / cell:.4f} cells along each axis",
    )
    cosines = (sets.tilted(cloud, random)[1] * normals).sum(axis=1)
    angles = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    report.verdict(
        angles.max() < sets.TILT + 0.01 and abs(angles.mean() - sets.TILT / 2) < 0.3,
        f"turned normals: {angles.mean():.2f} degrees on average, {angles.max():.2f} at the most",
    )
    strays = (sets.outlying(cloud, random)[0] != points).any(axis=1).mean()
    report.verdict(strays == sets.OUTLIERS, f"outliers: {strays:.2%}")


def check_scans(report: Report, conf: Path) -> None:
    """Every scan lies on the others, whose frame the .conf file gives."""
    from scipy.spatial import KDTree

    placed = [scans.placed(*scan) for scan in scans.placements(conf)]
    for index, (path, _, _) in enumerate(scans.placements(conf)):
        others = np.concatenate([points for k, (points, _) in enumerate(placed) if k != index])
        distances, _ = KDTree(others).query(placed[index][0])
        report.verdict(
            np.median(distances) < 5e-4,  # The step of the grid, in meters.
            f"{path.name}: median distance to the other scans {1e3 * np.median(distances):.3f} mm",
        )


if __name__ == "__main__":
    main()
