# SPDX-License-Identifier: GPL-3.0-or-later

"""Normals of points connected by faces, or in a scanner's grid."""

import numpy as np
import prefilter
import pytest
import solids
from prefilter.points.scan_files import read_points, read_range_grid

SCANS = solids.DATA.parent / "points" / "bunny"


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def hills(rows=40, columns=50):
    """A height field in a grid, its normals, and the grid."""
    x, y = np.meshgrid(np.arange(columns) / 50, np.arange(rows) / 50)
    points = np.stack([x, y, 0.1 * np.sin(5 * x) * np.cos(4 * y)], axis=-1)
    slope_x, slope_y = 0.5 * np.cos(5 * x) * np.cos(4 * y), -0.4 * np.sin(5 * x) * np.sin(4 * y)
    normals = unit(np.stack([-slope_x, -slope_y, np.ones_like(x)], axis=-1))
    grid = np.arange(rows * columns).reshape(rows, columns)
    return points.reshape(-1, 3), normals.reshape(-1, 3), grid


def degrees(found, wanted):
    return np.degrees(np.arccos(np.clip(np.sum(found * wanted, axis=1), -1, 1)))


def slow_mesh_normals(positions, triangles):
    normals = np.zeros_like(positions)
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    for k in range(3):
        np.add.at(normals, triangles[:, k], np.cross(b - a, c - a))
    return unit(normals)


def test_vertices_have_the_mean_of_their_triangles():
    ball = solids.sphere(1.0, 4, (0.0, 0.0, 0.0))
    found = prefilter.mesh_normals(ball.positions, ball.triangles)
    np.testing.assert_allclose(found, slow_mesh_normals(ball.positions, ball.triangles), atol=1e-12)
    assert degrees(found, unit(ball.positions)).max() < 3


def test_vertices_without_area_have_none():
    positions = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [np.nan, 0, 0], [5, 5, 5]])
    found = prefilter.mesh_normals(positions, [[0, 1, 2], [1, 2, 3], [0, 4, 0]])
    np.testing.assert_array_equal(found[[1, 2, 3]], [[0, 0, 1.0]] * 3)
    assert not found[[0, 4, 5]].any()


def test_a_grid_of_hills():
    points, normals, grid = hills()
    found, weights = prefilter.grid_normals(points, grid)
    inner = grid[1:-1, 1:-1].ravel()
    assert degrees(found[inner], normals[inner]).max() < 1.5
    assert degrees(found, normals).max() < 6
    steps = np.minimum(
        np.minimum(grid // 50, 39 - grid // 50), np.minimum(grid % 50, 49 - grid % 50)
    )
    wanted = found[:, 2] * (np.minimum(steps, 6).ravel() + 1) / 7
    np.testing.assert_allclose(weights, wanted, rtol=1e-6)


@pytest.mark.parametrize(
    "turned", [np.s_[:, :], np.s_[::-1], np.s_[:, ::-1], np.s_[::-1, ::-1]], ids=str
)
def test_the_side_of_the_scanner(turned):
    points, normals, grid = hills()
    found, _ = prefilter.grid_normals(points, grid[turned])
    assert degrees(found, normals).max() < 6
    above, _ = prefilter.grid_normals(points, grid[turned].T, viewpoint=(0.5, 0.4, 3.0))
    assert degrees(above, normals).max() < 6
    below, _ = prefilter.grid_normals(points, grid[turned], viewpoint=(0.5, 0.4, -3.0))
    np.testing.assert_allclose(below, -found)


def test_a_step_is_no_surface():
    points, normals, grid = hills()
    points[:, 2] -= np.where(points[:, 0] > 0.5, 0.3, 0)
    found, weights = prefilter.grid_normals(points, grid)
    assert degrees(found, normals).max() < 6
    assert weights.reshape(grid.shape)[:, 25:27].max() < 0.15


def test_holes():
    points, normals, grid = hills()
    seen = np.random.default_rng(0).random(grid.shape) < 0.8
    found, weights = prefilter.grid_normals(points, np.where(seen, grid, -1))
    has_normal = found.any(axis=1)
    assert not has_normal[~seen.ravel()].any()
    assert np.mean(has_normal[seen.ravel()]) > 0.95
    assert degrees(found[has_normal], normals[has_normal]).max() < 8
    np.testing.assert_array_equal(weights > 0, has_normal)


def test_missing_and_coincident_points():
    points, normals, grid = hills()
    points[[60, 1111]] = [(np.nan, 0, 0), (0, np.inf, 0)]
    points[700] = points[701]
    found, weights = prefilter.grid_normals(points, grid)
    assert not found[[60, 1111]].any()
    assert np.isfinite(weights).all()
    rest = np.delete(np.arange(len(points)), [60, 1111, 700, 701, 650, 651, 750, 751, 652, 749])
    assert degrees(found[rest], normals[rest]).max() < 8


@pytest.mark.parametrize(
    "grid", [np.zeros((0, 0), int), np.zeros((1, 1), int), np.full((3, 4), -1)]
)
def test_grids_without_a_cell(grid):
    normals, weights = prefilter.grid_normals(np.zeros((2, 3)), grid)
    assert not normals.any()
    assert not weights.any()


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        ("mesh_normals", [[[0, 1, 2]]], "triangles: triangle 0 names vertex 2, but there are 2"),
        ("mesh_normals", [[[0, 1, -1]]], "triangles: triangle 0 names vertex -1"),
        ("mesh_normals", [[[0.0, 1, 1]]], "triangles: dtype float64"),
        ("grid_normals", [[[0, 1], [-2, 0]]], "grid: place 2 names point -2; there are 2"),
        ("grid_normals", [[[0, 1], [1, 2]]], "grid: place 3 names point 2; there are 2"),
        ("grid_normals", [[0, 1]], r"grid: shape \(2,\)"),
    ],
)
def test_what_is_wrong_is_named(function, arguments, message):
    with pytest.raises(ValueError, match=message):
        getattr(prefilter, function)(np.zeros((2, 3)), *arguments)


def test_a_viewpoint_is_finite():
    with pytest.raises(ValueError, match="viewpoint: row 0 holds inf"):
        prefilter.grid_normals(np.zeros((2, 3)), [[0, 1]], viewpoint=(0.0, np.inf, 0.0))


def test_stop():
    points, _, grid = hills(200, 200)
    triangles = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:]], axis=-1).reshape(-1, 3)
    with pytest.raises(prefilter.Cancelled):
        prefilter.grid_normals(points, grid, progress=lambda fraction: False)
    with pytest.raises(prefilter.Cancelled):
        prefilter.mesh_normals(points, triangles, progress=lambda fraction: False)


@pytest.mark.skipif(not SCANS.exists(), reason="the range scans are not there")
def test_a_range_scan_of_the_bunny():
    # The scan was made in the model's coordinates, so nothing has to be moved.
    points = read_points(SCANS / "bun000.ply").positions
    grid = read_range_grid(SCANS / "bun000.ply")
    normals, weights = prefilter.grid_normals(points, grid)
    model = solids.meshes.read(solids.DATA / "stanford-bunny.obj")
    nearest, _, distances = prefilter.nearest_points(points, model.positions, model.triangles)
    errors = degrees(normals, unit(model.area_vectors)[nearest])
    sure = (weights > 0.3) & (distances < 2e-4)
    assert np.mean(sure) > 0.75
    assert np.mean(errors[sure] < 45) > 0.999
    assert np.mean(errors[sure]) < 12
    outward = prefilter.estimate_normals(points, viewpoint=(0.0, 0.1, 10.0))
    assert np.mean(np.sum(outward * normals, axis=1)[sure] > 0) > 0.9999


def ply(path, points, lists):
    """A file in text, with elements of one list a row."""
    head = ["ply", "format ascii 1.0", "obj_info num_rows 40", "obj_info num_cols 50"]
    head += [f"element vertex {len(points)}", *(f"property double {axis}" for axis in "xyz")]
    rows = [" ".join(map(repr, point)) for point in points.tolist()]
    for name, values in lists.items():
        head += [f"element {name} {len(values)}", "property list uchar int vertex_indices"]
        rows += [" ".join(map(str, [len(row), *row])) for row in values]
    path.write_text("\n".join([*head, "end_header", *rows, ""]))
    return path


def test_a_file_with_a_grid(tmp_path):
    points, _, grid = hills()
    grid[:, 1] = grid[:, 48] = -1
    grid[:, 0] = -1
    cells = [[index] if index >= 0 else [] for index in grid.ravel()]
    source = ply(tmp_path / "scan.ply", points, {"range_grid": cells})
    report = prefilter.reconstruct_file(source, tmp_path / "mesh.ply", depth=5)
    # Two columns that the grid leaves out, and one that has no neighbors: no estimate drops any.
    assert report.dropped == 4 * 40
    assert not report.is_flipped


def test_a_file_with_faces(tmp_path):
    ball = solids.sphere(1.0, 4, (0.0, 0.0, 0.0)).flipped()
    source = ply(tmp_path / "ball.ply", ball.positions, {"face": ball.triangles})
    assert prefilter.reconstruct_file(source, tmp_path / "mesh.ply", depth=5).is_flipped
    few = ply(tmp_path / "few.ply", ball.positions, {"face": ball.triangles[:9]})
    report = prefilter.reconstruct_file(few, tmp_path / "mesh.ply", depth=5)
    assert report.dropped == 0
    assert not report.is_flipped
