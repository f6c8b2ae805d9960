# SPDX-License-Identifier: GPL-3.0-or-later

"""Contours with edges and corners: polyhedra whose edges are known, and combinations of them."""

import numpy as np
import prefilter
import pytest
from solids import box, random_rotation


def cube(seed, scale=1.0, middle=(0.0, 0.0, 0.0)):
    made = box((-0.5,) * 3, (0.5,) * 3).transformed(scale * random_rotation(seed), middle)
    return made.positions, made.triangles


def cone(facets=256):
    """A cone with its tip at (0, 0, 1/2)."""
    angles = np.arange(facets) * 2 * np.pi / facets
    ring = np.stack([0.5 * np.cos(angles), 0.5 * np.sin(angles), np.full(facets, -0.5)], axis=1)
    i = np.arange(facets)
    j = (i + 1) % facets
    side = np.stack([i, j, np.full(facets, facets)], axis=1)
    base = np.stack([j, i, np.full(facets, facets + 1)], axis=1)
    return np.concatenate([ring, [[0, 0, 0.5], [0, 0, -0.5]]]), np.concatenate([side, base])


def normals(positions, triangles):
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    crossed = np.cross(b - a, c - a)
    sizes = np.linalg.norm(crossed, axis=1, keepdims=True)
    return crossed / np.maximum(sizes, 1e-300), sizes[:, 0] / 2


def planes(mesh):
    """The distinct planes of a polyhedron: unit normals and offsets."""
    found, _ = normals(*mesh)
    offsets = np.einsum("ij,ij->i", found, mesh[0][mesh[1][:, 0]])
    rows = np.unique(np.round(np.column_stack([found, offsets]), 9), axis=0)
    return rows[:, :3], rows[:, 3]


def fans(triangles):
    """Whether every edge is there once each way, and the triangles of each vertex are one fan."""
    after = {}
    for row in triangles.tolist():
        for k in range(3):
            a, b, c = row[k], row[(k + 1) % 3], row[(k + 2) % 3]
            if after.setdefault(a, {}).setdefault(b, c) != c:
                return False
    for link in after.values():
        start = next(iter(link))
        at, steps = link[start], 1
        while at != start:
            if at not in link or steps > len(link):
                return False
            at, steps = link[at], steps + 1
        if steps != len(link):
            return False
    return True


def tree_of(mesh, bounds=None, depth=6):
    return prefilter.voxelize(*mesh, depth=depth, bounds=bounds)


def cell_of(tree):
    low, high = np.array(tree.bounds)
    return (high - low)[0] / 2**tree.depth


@pytest.mark.parametrize("cleanup", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_turned_cubes_have_their_faces_edges_and_corners(seed, cleanup):
    mesh = cube(seed)
    tree = tree_of(mesh)
    positions, triangles = tree.contour(interpolant="sharp", sources=[mesh], cleanup=cleanup)
    assert fans(triangles)
    directions, offsets = planes(mesh)
    found, areas = normals(positions, triangles)
    agreement = found @ directions.T
    assert areas[agreement.max(axis=1) < np.cos(np.radians(1))].sum() < 1e-3 * areas.sum()
    assert np.abs(areas.sum() - 6.0) < 1e-3
    for corner in mesh[0]:
        distances = np.linalg.norm(positions - corner, axis=1)
        assert distances.min() < 1e-9
    # No vertex is in front of a plane, and nearly all lie on one.
    heights = positions @ directions.T - offsets
    assert heights.max() < 1e-6
    assert np.quantile(np.abs(heights).min(axis=1), 0.99) < 0.01 * cell_of(tree)


@pytest.mark.parametrize("operation", ["union", "intersection", "difference"])
def test_rims_lie_on_both_operands(operation):
    first, second = cube(5), cube(57, 0.8, (0.45, 0.35, 0.3))
    corners = np.concatenate([first[0], second[0]])
    bounds = prefilter.cube_around((corners.min(0), corners.max(0)), depth=7)
    tree = getattr(tree_of(first, bounds, 7), operation)(tree_of(second, bounds, 7))
    traced = tree.traced_contour([first, second], cleanup=False)
    assert fans(traced.triangles)
    found, areas = normals(traced.positions, traced.triangles)
    expected, _ = normals(
        np.concatenate([first[0], second[0]]), np.concatenate([first[1], second[1] + 8])
    )
    sign = np.where((traced.origins >= 12) & (operation == "difference"), -1.0, 1.0)
    angles = np.einsum("ij,ij->i", found, expected[traced.origins]) * sign
    assert areas[angles < np.cos(np.radians(10))].sum() < 0.01 * areas.sum()
    # Vertices between facets of both are on a plane of each.
    owner = traced.origins >= 12
    on_first = np.zeros(len(traced.positions), bool)
    on_second = on_first.copy()
    on_first[traced.triangles[~owner]] = True
    on_second[traced.triangles[owner]] = True
    rim = traced.positions[on_first & on_second]
    assert len(rim) > 128
    for mesh in (first, second):
        directions, offsets = planes(mesh)
        heights = np.abs(rim @ directions.T - offsets).min(axis=1) / cell_of(tree)
        assert heights.mean() < 0.02
        assert np.quantile(heights, 0.95) < 0.1


def test_no_triangle_straddles_groups():
    mesh = cube(1)
    groups = np.repeat(np.arange(6), 2) % 3
    split = (*mesh, np.arange(12))
    for source, count in (((*mesh, groups), 6), (split, 12)):
        traced = tree_of(mesh).traced_contour([source])
        assert fans(traced.triangles)
        _, areas = normals(traced.positions, traced.triangles)
        shares = np.bincount(traced.origins, areas, 12)
        assert np.count_nonzero(shares) == count
        assert shares[shares > 0] == pytest.approx(6.0 / count, rel=0.02)


def test_cones_have_their_tip():
    positions, triangles = cone()
    for depth in (5, 6):
        tree = tree_of((positions, triangles), depth=depth)
        found, facets = tree.contour(interpolant="sharp", sources=[(positions, triangles)])
        assert fans(facets)
        assert np.linalg.norm(found - positions[-2], axis=1).min() < 1e-9


def test_smooth_shapes_are_as_by_plane():
    u, v = np.meshgrid(np.arange(96) / 96 * 2 * np.pi, np.arange(1, 48) / 48 * np.pi)
    grid = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=2)
    rows = np.arange(46 * 96).reshape(46, 96)
    right = np.roll(rows, -1, axis=1)
    sides = np.concatenate(
        [
            np.stack([rows, rows + 96, right], axis=2).reshape(-1, 3),
            np.stack([right, rows + 96, right + 96], axis=2).reshape(-1, 3),
        ]
    )
    poles = 47 * 96
    i, j = np.arange(96), (np.arange(96) + 1) % 96
    caps = np.concatenate(
        [
            np.stack([np.full(96, poles), i, j], axis=1),
            np.stack([np.full(96, poles + 1), j + 46 * 96, i + 46 * 96], axis=1),
        ]
    )
    positions = np.concatenate([grid.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    mesh = positions, np.concatenate([sides, caps])
    tree = tree_of(mesh)
    plane = tree.contour(interpolant="plane", cleanup=False)
    sharp = tree.contour(interpolant="sharp", sources=[mesh], cleanup=False)
    assert np.array_equal(plane[1], sharp[1])
    assert np.array_equal(plane[0], sharp[0])


def test_threads_do_not_matter():
    meshes = [cube(5), cube(6, 0.8, (0.45, 0.35, 0.3))]
    corners = np.concatenate([mesh[0] for mesh in meshes])
    bounds = prefilter.cube_around((corners.min(0), corners.max(0)), depth=6)
    tree = tree_of(meshes[0], bounds).difference(tree_of(meshes[1], bounds))
    one, two = (tree.traced_contour(meshes, threads=threads) for threads in (1, 3))
    for name in ("positions", "triangles", "origins"):
        assert np.array_equal(getattr(one, name), getattr(two, name)), name


def nasty_sources():
    mesh = cube(2)
    soup = mesh[0][mesh[1]].reshape(-1, 3), np.arange(36).reshape(-1, 3)
    flat = mesh[0], np.concatenate([mesh[1], [[0, 0, 1], [2, 2, 2]]])
    return {
        "soup": [soup],
        "zero area": [flat],
        "inside out": [(mesh[0], mesh[1][:, ::-1])],
        "twice": [mesh, mesh],
        "one triangle": [(mesh[0], mesh[1][:1])],
        "elsewhere": [(mesh[0] + 100.0, mesh[1])],
        "huge": [(mesh[0] * 1e100, mesh[1])],
        "tiny": [(mesh[0] * 1e-100, mesh[1])],
        "open": [(mesh[0], mesh[1][2:])],
    }


@pytest.mark.parametrize("name", nasty_sources())
def test_sources_that_are_odd_leave_it_closed(name):
    tree = tree_of(cube(2), depth=5)
    positions, triangles = tree.contour(interpolant="sharp", sources=nasty_sources()[name])
    assert fans(triangles)
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(1.0, rel=0.02)


def test_trees_of_one_value():
    mesh = cube(2)
    empty = tree_of(mesh).difference(tree_of(mesh))
    positions, triangles = empty.contour(interpolant="sharp", sources=[mesh])
    assert len(positions) == len(triangles) == 0


def test_a_soup_is_as_by_plane():
    """No edges are placed if one or two cells hold parts of everything, which bounds the work."""
    positions = np.random.default_rng(1).random((1500, 3))
    triangles = np.arange(1500).reshape(-1, 3)
    tree = prefilter.voxelize(positions, triangles, depth=5)
    smooth = tree.contour(interpolant="plane", cleanup=False)[1]
    sharp = tree.contour(sources=[(positions, triangles)], cleanup=False)[1]
    # Each edge that is placed adds a vertex and its triangles.
    assert len(smooth) > 10_000
    assert len(sharp) < 1.01 * len(smooth)
