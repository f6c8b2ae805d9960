# SPDX-License-Identifier: GPL-3.0-or-later

"""Surfaces from points, against the surfaces that the points were sampled from."""

import re
from pathlib import Path

import numpy as np
import prefilter
import pytest
import solids
from clouds import Cloud, sphere, torus

CLOUDS = {"sphere": sphere(40_000), "torus": torus(60_000)}
DEPTH = 6


def _rebuilt(cloud: Cloud, **options: object) -> tuple[np.ndarray, np.ndarray, float]:
    """Positions, triangles, and the mean distance of vertices from the surface in cells."""
    report = prefilter.ReconstructionReport()
    positions, triangles = prefilter.reconstruct(
        cloud.points, cloud.normals, report=report, **({"depth": DEPTH} | options)
    )
    assert (report.vertices, report.triangles) == (len(positions), len(triangles))
    return positions, triangles, float(np.abs(cloud.distance(positions)).mean() / report.cell)


@pytest.mark.parametrize("name", CLOUDS)
@pytest.mark.parametrize(
    ("options", "limit"),
    [
        ({}, 0.004),
        ({"smooth": False}, 0.004),
        ({"fit": False}, 0.06),
        ({"fit": False, "smooth": False}, 0.06),
        ({"fit": False, "smooth": False, "isovalue": "half"}, 0.06),
        ({"fit": False, "isovalue": 0.5}, 0.06),
        ({"wavelet": "d4"}, 0.004),
        ({"wavelet": "d4", "fit": False}, 0.1),
        ({"wavelet": "d4", "fit": False, "smooth": False, "isovalue": "half"}, 0.2),
    ],
)
def test_surface_is_closed_and_near(name: str, options: dict[str, object], limit: float) -> None:
    positions, triangles, error = _rebuilt(CLOUDS[name], **options)
    assert solids.surface_faults(positions, triangles).none
    assert error < limit


def test_outside_is_where_normals_point() -> None:
    positions, triangles, _ = _rebuilt(CLOUDS["sphere"])
    assert solids.mesh_volume(positions, triangles) == pytest.approx(4 / 3 * np.pi, rel=1e-3)


@pytest.mark.parametrize("wavelet", ["haar", "d4"])
@pytest.mark.parametrize("depth", [1, 2, 3, 5, 6, 8])
def test_all_depths(depth: int, wavelet: str) -> None:
    positions, triangles, _ = _rebuilt(CLOUDS["sphere"], depth=depth, wavelet=wavelet)
    assert solids.surface_faults(positions, triangles).none


@pytest.mark.parametrize("wavelet", ["haar", "d4"])
def test_threads_and_memory_change_nothing(wavelet: str) -> None:
    cloud = CLOUDS["torus"]
    expected = _rebuilt(cloud, depth=8, threads=1, wavelet=wavelet)
    report = prefilter.ReconstructionReport()
    found = prefilter.reconstruct(
        cloud.points,
        cloud.normals,
        depth=8,
        threads=3,
        memory_limit=0,
        wavelet=wavelet,
        report=report,
    )
    assert report.is_spilled
    for a, b in zip(expected, found, strict=False):
        np.testing.assert_array_equal(a, b)


def test_order_of_points_changes_rounding_alone() -> None:
    cloud = CLOUDS["torus"]
    order = np.random.default_rng(3).permutation(len(cloud.points))
    positions, triangles, _ = _rebuilt(cloud)
    other = prefilter.reconstruct(cloud.points[order], cloud.normals[order], depth=DEPTH)
    np.testing.assert_array_equal(other[1], triangles)
    np.testing.assert_allclose(other[0], positions, atol=1e-5)


def test_unusable_points_are_counted() -> None:
    cloud = sphere(20_000)
    points, normals = cloud.points.copy(), cloud.normals.copy()
    points[0], points[1], points[2] = np.nan, np.inf, -np.inf
    weights = np.ones(20_000)
    weights[3:5] = 0.0
    report = prefilter.ReconstructionReport()
    found = prefilter.reconstruct(points, normals, weights=weights, depth=6, report=report)
    assert (report.points, report.dropped) == (20_000, 5)
    assert report.causes == {"not_finite": 3, "huge": 0, "weightless": 2, "normalless": 0}
    expected = prefilter.reconstruct(points[5:], normals[5:], depth=6)
    np.testing.assert_array_equal(found[0], expected[0])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"trim": 1e-6}, "trim: 1e-06 cells leave no triangle; more are needed, or none"),
        ({"isovalue": 40}, "isovalue: 40 is nowhere; values are about 0 outside and 1 inside"),
    ],
)
def test_a_surface_of_nothing_is_refused(
    options: dict[str, float], message: str, tmp_path: Path
) -> None:
    cloud = sphere(2000)
    with pytest.raises(ValueError, match=re.escape(message)):
        prefilter.reconstruct(cloud.points, cloud.normals, depth=6, **options)
    source, target = tmp_path / "points.ply", tmp_path / "mesh.ply"
    rows = np.hstack([cloud.points, cloud.normals])
    header = "ply\nformat ascii 1.0\nelement vertex 2000\n"
    header += "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    text = "\n".join(" ".join(f"{value:.6g}" for value in row) for row in rows)
    source.write_text(f"{header}end_header\n{text}\n")
    target.write_text("before")
    with pytest.raises(ValueError, match=re.escape(message)):
        prefilter.reconstruct_file(source, target, depth=6, **options)
    assert target.read_text() == "before"
    assert sorted(tmp_path.iterdir()) == [target, source]


def test_strays_are_left_out() -> None:
    cloud = sphere(20_000)
    points = np.concatenate([cloud.points, [(20.0, 0.0, 0.0), (0.0, -1e6, 0.0)]])
    normals = np.concatenate([cloud.normals, [(0.0, 0.0, 1.0)] * 2])
    report = prefilter.ReconstructionReport()
    found = prefilter.reconstruct(points, normals, depth=6, report=report)
    assert (report.points, report.dropped, report.strays) == (20_002, 0, 2)
    expected = prefilter.reconstruct(cloud.points, cloud.normals, depth=6)
    np.testing.assert_array_equal(found[0], expected[0])
    np.testing.assert_array_equal(found[1], expected[1])


@pytest.mark.parametrize("wavelet", ["haar", "d4"])
def test_automatic_depth(wavelet: str, tmp_path: Path) -> None:
    cloud = CLOUDS["torus"]
    report = prefilter.ReconstructionReport()
    found = prefilter.reconstruct(cloud.points, cloud.normals, wavelet=wavelet, report=report)
    faces = 4 * np.pi**2 * 1.0 * 0.4 / report.cell**2
    assert 1 <= len(cloud.points) / faces < 4
    expected = prefilter.reconstruct(
        cloud.points, cloud.normals, wavelet=wavelet, depth=report.depth
    )
    np.testing.assert_array_equal(found[0], expected[0])
    np.testing.assert_array_equal(found[1], expected[1])
    scan = prefilter.ScanPoints(cloud.points, cloud.normals)
    for options in ({"threads": 1}, {"threads": 3, "memory_limit": 0}):
        streamed = prefilter.reconstruct_file(
            scan, tmp_path / "torus.ply", wavelet=wavelet, **options
        )
        assert (streamed.depth, streamed.cell) == (report.depth, report.cell)


def test_depth_from_a_cell_size() -> None:
    cloud = CLOUDS["sphere"]
    report = prefilter.ReconstructionReport()
    prefilter.reconstruct(cloud.points, cloud.normals, cell_size=0.1, report=report)
    assert report.cell <= 0.1 < 2 * report.cell
    assert report.depth < 6
    prefilter.reconstruct(cloud.points, cloud.normals, depth=4, report=report)
    assert report.depth == 4


def test_normals_are_estimated() -> None:
    cloud = CLOUDS["sphere"]
    report = prefilter.ReconstructionReport()
    positions, triangles = prefilter.reconstruct(cloud.points, depth=DEPTH, report=report)
    assert solids.surface_faults(positions, triangles).none
    assert np.abs(cloud.distance(positions)).mean() < 0.01 * report.cell
