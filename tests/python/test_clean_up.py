# SPDX-License-Identifier: GPL-3.0-or-later

"""Contours with Clean Up: its guarantees about triangles, checked independently."""

import itertools
from fractions import Fraction

import numpy as np
import prefilter
import pytest
import solids


def angles_of(positions, triangles):
    """The smallest angle of each triangle, in degrees."""
    corners = positions[triangles]
    smallest = np.full(len(triangles), 180.0)
    for k in range(3):
        u = corners[:, (k + 1) % 3] - corners[:, k]
        v = corners[:, (k + 2) % 3] - corners[:, k]
        angle = np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1))
        smallest = np.minimum(smallest, np.degrees(angle))
    return smallest


def narrow_share(positions, triangles):
    return (angles_of(positions, triangles) < 15).mean()


def is_closed_manifold(triangles):
    """Whether each edge occurs once in each direction, and each vertex has one fan."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    codes = edges[:, 0].astype(np.int64) << 32 | edges[:, 1]
    back = edges[:, 1].astype(np.int64) << 32 | edges[:, 0]
    if len(np.unique(codes)) != len(codes) or not np.array_equal(np.sort(codes), np.sort(back)):
        return False
    following = {}
    for a, b, c in triangles.tolist():
        for v, p, q in ((a, b, c), (b, c, a), (c, a, b)):
            following.setdefault(v, {})[p] = q
    for fan in following.values():
        start = at = next(iter(fan))
        steps = 0
        while steps == 0 or at != start:
            at = fan[at]
            steps += 1
        if steps != len(fan):
            return False
    return True


def exact(point):
    return tuple(Fraction(float(x)) for x in point)


def volume(a, b, c, d):
    """Six times the volume of a tetrahedron, exactly."""
    u, v, w = ([p[i] - a[i] for i in range(3)] for p in (b, c, d))
    return (
        u[0] * (v[1] * w[2] - v[2] * w[1])
        + u[1] * (v[2] * w[0] - v[0] * w[2])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
    )


def turn(a, b, c, axis):
    """Twice the area of a triangle seen along an axis, exactly."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    return (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i])


def does_cross_in_plane(triangle, p, q):
    """Clips a segment to a triangle in its plane."""
    axis = max(range(3), key=lambda k: abs(turn(*triangle, k)))
    side = turn(*triangle, axis)
    first, last = Fraction(0), Fraction(1)
    for k in range(3):
        a, b = triangle[k], triangle[(k + 1) % 3]
        at_p, at_q = turn(a, b, p, axis) * side, turn(a, b, q, axis) * side
        if at_p < 0 and at_q < 0:
            return False
        if at_p < 0:
            first = max(first, at_p / (at_p - at_q))
        elif at_q < 0:
            last = min(last, at_p / (at_p - at_q))
    return first <= last


def does_cross(triangle, p, q):
    """Whether a segment meets a triangle."""
    p_side, q_side = volume(*triangle, p), volume(*triangle, q)
    if p_side * q_side > 0:
        return False
    if p_side == q_side == 0:
        return does_cross_in_plane(triangle, p, q)
    sides = [volume(p, q, triangle[k], triangle[(k + 1) % 3]) for k in range(3)]
    return all(side >= 0 for side in sides) or all(side <= 0 for side in sides)


def crossings(positions, triangles):
    """The pairs of triangles that share no edge and intersect beyond their shared vertices."""
    corners = positions[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    found = []
    for t in range(len(triangles)):
        near = np.nonzero((low <= high[t]).all(axis=1) & (high >= low[t]).all(axis=1))[0]
        near = near[near > t]
        # Those clearly on one side of a plane need no exact arithmetic.
        of_t = ((corners[near] - corners[t, 0]) * normals[t]).sum(axis=2)
        of_them = ((corners[t] - corners[near, :1]) * normals[near, None]).sum(axis=2)
        apart = [
            (heights > 1e-9).all(axis=1) | (heights < -1e-9).all(axis=1)
            for heights in (of_t, of_them)
        ]
        for u in near[~(apart[0] | apart[1])]:
            shared = set(triangles[t].tolist()) & set(triangles[u].tolist())
            if len(shared) == 2:
                continue
            pair = []
            for one, other in ((t, u), (u, t)):
                whole = [exact(p) for p in corners[one]]
                others = [
                    exact(p)
                    for v, p in zip(triangles[other].tolist(), corners[other], strict=True)
                    if v not in shared
                ]
                pair += [does_cross(whole, p, q) for p, q in itertools.combinations(others, 2)]
            if any(pair):
                found.append((t, int(u)))
    return found


def waves():
    """Curved sheets as thin as a cell, and a cell apart."""
    size = 13
    x, y, z = np.indices((size,) * 3)
    values = np.sin(0.7 * z + 4 * np.sin(0.31 * x) + 3 * np.cos(0.43 * y)) + 0.7
    values = values.clip(0, 1) * np.random.default_rng(0).uniform(0.8, 1, (size,) * 3)
    for axis in (x, y, z):
        values[(axis < 2) | (axis > size - 3)] = 0
    return values.astype(np.float32)


@pytest.mark.parametrize("interpolant", ["occupancy", "plane"])
@pytest.mark.parametrize("center", [(0.2, 0.3, 0.4), (0.0, 0.0, 0.0)])
def test_few_triangles_are_narrow_and_normals_are_as_good(interpolant, center):
    sphere = solids.sphere(40.0, 6, center)
    octree = prefilter.voxelize(
        sphere.positions, sphere.triangles, depth=7, bounds=((-64,) * 3, (64,) * 3)
    )
    raw = octree.contour(interpolant=interpolant, cleanup=False)
    positions, triangles = octree.contour(interpolant=interpolant)
    assert narrow_share(*raw) > 0.1
    assert narrow_share(positions, triangles) < 0.005
    assert is_closed_manifold(triangles)
    assert set(map(tuple, positions.tolist())) <= set(map(tuple, raw[0].tolist()))

    def mean_error(mesh):
        corners = mesh[0][mesh[1]] - center
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas = np.linalg.norm(normals, axis=1)
        middles = corners.mean(axis=1)
        cosines = (normals * middles).sum(axis=1) / (areas * np.linalg.norm(middles, axis=1))
        return np.average(np.degrees(np.arccos(cosines.clip(-1, 1))), weights=areas)

    assert mean_error((positions, triangles)) < 1.02 * mean_error(raw)


def test_the_number_of_threads_makes_no_difference():
    sphere = solids.sphere(100.0, 6, (0.2, 0.3, 0.4))
    octree = prefilter.voxelize(sphere.positions, sphere.triangles, depth=8)
    one = octree.contour(interpolant="occupancy", threads=1)
    for threads in (2, 5):
        other = octree.contour(interpolant="occupancy", threads=threads)
        np.testing.assert_array_equal(other[0], one[0])
        np.testing.assert_array_equal(other[1], one[1])


@pytest.mark.parametrize("interpolant", ["occupancy", "linear"])
def test_thin_sheets_do_not_cross(interpolant):
    grid = waves()
    raw = prefilter.contour(grid, interpolant=interpolant, cleanup=False)
    assert not crossings(*raw)
    positions, triangles = prefilter.contour(grid, interpolant=interpolant)
    assert len(triangles) < 0.9 * len(raw[1])
    assert is_closed_manifold(triangles)
    assert not crossings(positions, triangles)


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_scales_make_no_difference(scale):
    sphere = solids.sphere(1.0, 4, (0.0, 0.0, 0.0))
    _, expected = prefilter.voxelize(sphere.positions, sphere.triangles, depth=5).contour()
    octree = prefilter.voxelize(scale * sphere.positions, sphere.triangles, depth=5)
    positions, triangles = octree.contour()
    assert narrow_share(positions / scale, triangles) < 0.005
    assert abs(len(triangles) - len(expected)) < 0.02 * len(expected)


def test_an_empty_contour_stays_empty():
    positions, triangles = prefilter.contour(np.zeros((4, 4, 4)))
    assert positions.shape == (0, 3)
    assert triangles.shape == (0, 3)
