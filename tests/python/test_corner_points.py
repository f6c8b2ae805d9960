# SPDX-License-Identifier: GPL-3.0-or-later

"""Corner points on source meshes, charts of UV maps, and measures: on boxes and spheres."""

import numpy as np
import prefilter
import pytest
import solids

BOX = solids.box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
SPHERE = solids.sphere(1.0, 4, (0.0, 0.0, 0.0))


def sides(mesh):
    """Returns which of six sides each triangle of a box is on."""
    corners = mesh.positions[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    axes = np.abs(normals).argmax(axis=1)
    return (2 * axes + (normals[np.arange(len(axes)), axes] > 0)).astype(np.int32)


def subdivided(positions, triangles):
    """Returns each triangle as four, with vertices of their own, and which it was."""
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    corners = np.concatenate([np.stack(part, axis=1) for part in parts])
    return corners, np.tile(np.arange(len(triangles)), 4)


@pytest.mark.parametrize("threads", [1, 3])
def test_corners_stay_on_their_side(threads):
    corners, origins = subdivided(BOX.positions, BOX.triangles)
    points, triangles = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    labels = sides(BOX)
    points = points * 1.01 - 0.005
    found = prefilter.corner_points(
        points, triangles, origins, BOX.positions, BOX.triangles, labels, threads=threads
    )
    assert len(found.triangles) > len(points)
    np.testing.assert_array_equal(
        labels[found.triangles[found.corners]], np.repeat(labels[origins][:, None], 3, axis=1)
    )
    on = np.einsum("ij,ijk->ik", found.weights, BOX.positions[BOX.triangles[found.triangles]])
    wanted = np.clip(points[triangles], (0, 0, 0), (1, 2, 3))
    for corner in range(3):
        at = on[found.corners[:, corner]]
        axis, side = labels[origins] // 2, labels[origins] % 2
        rows = np.arange(len(at))
        expected = wanted[:, corner].copy()
        expected[rows, axis] = side * np.array([1.0, 2.0, 3.0])[axis]
        np.testing.assert_allclose(at, expected, atol=1e-12)


def test_one_label_is_nearest_points():
    moved = SPHERE.positions * 1.1 + 0.01
    count = len(SPHERE.triangles)
    found = prefilter.corner_points(
        moved,
        SPHERE.triangles,
        np.zeros(count, np.int64),
        SPHERE.positions,
        SPHERE.triangles,
        np.full(count, 7),
    )
    triangles, weights, _ = prefilter.nearest_points(moved, SPHERE.positions, SPHERE.triangles)
    np.testing.assert_array_equal(found.triangles, triangles)
    np.testing.assert_array_equal(found.weights, weights)
    np.testing.assert_array_equal(found.corners, SPHERE.triangles)


def test_identical_triangles_with_labels_of_their_own():
    positions = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    twice = np.array([[0, 1, 2], [0, 1, 2]])
    for label in (0, 1):
        found = prefilter.corner_points(
            positions, twice[:1], [label], positions, twice, np.array([0, 1])
        )
        assert set(found.triangles) == {label}


def test_charts_end_at_seams_of_any_map():
    flat = BOX.positions[BOX.triangles].astype(np.float32)
    whole = np.zeros((12, 3, 2), np.float32)
    assert set(prefilter.uv_charts(BOX.positions, BOX.triangles, [whole])) == {0}
    by_side = whole.copy()
    by_side[:] = sides(BOX)[:, None, None]
    charts = prefilter.uv_charts(BOX.positions, BOX.triangles, [flat[..., :2], by_side])
    assert len(set(charts)) == 6
    for side in range(6):
        assert len(set(charts[sides(BOX) == side])) == 1


def tube(columns=24, rows=6, turns=0.0):
    """The side of a cylinder with an unrolled UV map, slit along a line that may wind around it."""
    around, up = np.meshgrid(np.arange(columns), np.arange(rows))
    angles = np.arange(columns) / columns * 2 * np.pi
    positions = np.array(
        [(np.cos(a), np.sin(a), z / rows) for z in range(rows + 1) for a in angles], np.float32
    )
    slit = np.floor(up * turns / rows * columns).astype(int)
    at, u = around.ravel(), (around - slit).ravel() % columns

    def corner(right, above):
        vertices = (at + right) % columns + (up.ravel() + above) * columns
        return vertices, np.stack([(u + right) / columns, (up.ravel() + above) / rows], axis=1)

    faces = ([(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)])
    corners = [[corner(*one) for one in face] for face in faces]
    triangles = np.concatenate([np.stack([v for v, _ in face], axis=1) for face in corners])
    uvs = np.concatenate([np.stack([w for _, w in face], axis=1) for face in corners])
    return positions, triangles, uvs.astype(np.float32)


def assert_no_vertex_has_two_uvs(triangles, uvs, charts):
    seen = {}
    for triangle, corners, chart in zip(triangles, uvs, charts, strict=True):
        for vertex, uv in zip(triangle, corners, strict=True):
            np.testing.assert_allclose(seen.setdefault((chart, vertex), uv), uv, atol=1e-4)


@pytest.mark.parametrize("turns", [0.0, 0.5])
def test_charts_that_meet_themselves_are_cut(turns):
    positions, triangles, uvs = tube(turns=turns)
    charts = prefilter.uv_charts(positions, triangles, [uvs])
    assert_no_vertex_has_two_uvs(triangles, uvs, charts)
    if turns == 0.0:
        assert sorted(np.bincount(charts)) == pytest.approx([144, 144], abs=12)
        # Half way around from the slit, from column to column.
        assert set(charts[uvs[..., 0].max(axis=1) < 0.4]) == {0}
        assert len(set(charts[uvs[..., 0].min(axis=1) > 0.6])) == 1


def test_triangles_around_a_pole_with_uvs_of_their_own_are_parted():
    """Triangles at the pole are connected by the ring below, and have their own UVs at the pole."""
    positions, triangles, uvs = tube()
    ring = np.arange(24) + 24 * 6
    pole = len(positions)
    fan = np.stack([ring, np.roll(ring, -1), np.full(24, pole)], axis=1)
    u = np.arange(24) / 24
    at = np.stack([u, u + 1 / 24, u + 1 / 48], axis=1)
    corners = np.stack([at, np.broadcast_to([1.0, 1.0, 1.2], at.shape)], axis=2)
    triangles = np.concatenate([triangles, fan])
    uvs = np.concatenate([uvs, corners.astype(np.float32)])
    positions = np.concatenate([positions, [(0, 0, 1.2)]]).astype(np.float32)
    charts = prefilter.uv_charts(positions, triangles, [uvs])
    assert_no_vertex_has_two_uvs(triangles, uvs, charts)
    assert len(set(charts[-24:])) == 24


def test_charts_are_cut_where_each_face_has_all_of_an_image():
    """UVs as after Reset UVs: pieces are connected only where the squares fit."""
    positions, triangles, uvs = tube()
    uvs = uvs * (24, 6) - np.floor((uvs * (24, 6)).min(axis=1, keepdims=True) + 0.01)
    charts = prefilter.uv_charts(positions, triangles, [uvs.astype(np.float32)])
    assert_no_vertex_has_two_uvs(triangles, uvs, charts)


def test_an_edge_of_three_faces_is_a_seam():
    positions = np.array([(0, 0, 0), (0, 0, 1), (1, 0, 0), (-1, 1, 0), (-1, -1, 0)], np.float32)
    triangles = np.array([(0, 1, 2), (1, 0, 3), (0, 1, 4)])
    assert list(prefilter.uv_charts(positions, triangles, [])) == [0, 1, 2]
    assert list(prefilter.uv_charts(positions, triangles[:2], [])) == [0, 0]


def test_vertices_at_one_place_are_no_seam():
    split = BOX.positions[BOX.triangles].reshape(-1, 3)
    charts = prefilter.uv_charts(split, np.arange(36).reshape(12, 3), [])
    assert set(charts) == {0}


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_measures_of_a_box(dtype):
    positions = np.concatenate([BOX.positions, [[9.0, 9.0, 9.0]]]).astype(dtype)
    triangles = BOX.triangles.astype(np.int32)
    found = prefilter.measure_mesh(positions, triangles)
    np.testing.assert_array_equal(found.box, [(0, 0, 0), (1, 2, 3)])
    assert found.area == pytest.approx(22)
    assert found.volume == pytest.approx(6)
    assert prefilter.measure_mesh(positions, triangles[:, ::-1]).volume == pytest.approx(-6)


def test_measures_do_not_depend_on_threads_and_precision():
    narrow = SPHERE.positions.astype(np.float32), SPHERE.triangles.astype(np.int32)
    wide = narrow[0].astype(np.float64), narrow[1].astype(np.int64)
    one, other = (
        prefilter.measure_mesh(*mesh, threads=threads) for mesh, threads in ((narrow, 1), (wide, 4))
    )
    assert (one.area, one.volume) == (other.area, other.volume)
    np.testing.assert_array_equal(one.box, other.box)
    first, second = (
        prefilter.voxelize(*mesh, depth=6, threads=threads)
        for mesh, threads in ((narrow, 1), (wide, 4))
    )
    np.testing.assert_array_equal(first.dense(), second.dense())
