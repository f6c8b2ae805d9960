# SPDX-License-Identifier: GPL-3.0-or-later

"""Polygons as triangles: they cover the inside of a polygon once, and nothing else."""

import math

import numpy as np
import pytest
from prefilter import _native


def triangulated(points, sizes=None):
    """Returns the triangles of polygons whose corners are all vertices in their order."""
    points = np.array([(*point, 0.0)[:3] for point in points], np.float64)
    sizes = np.array([len(points)] if sizes is None else sizes, np.int64)
    corners = np.arange(len(points), dtype=np.int64)
    return _native.triangulate_polygons(points, corners, sizes, None)


def areas(points, triangles):
    a, b, c = (np.array(points, np.float64)[triangles[:, k], :2] for k in range(3))
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


def windings(points, places):
    """Returns winding numbers of a polygon around points, by the angles that its sides subtend."""
    points = np.array(points, np.float64)[:, :2]
    found = np.empty(len(places))
    for number, place in enumerate(places):
        x, y = (points - place).T
        angles = np.arctan2(y, x)
        turns = np.diff(np.append(angles, angles[0]))
        found[number] = ((turns + math.pi) % (2 * math.pi) - math.pi).sum() / (2 * math.pi)
    return np.rint(found).astype(int)


def check(points, count=400):
    """Compares the number of triangles that cover random points with the winding number there."""
    triangles = triangulated(points)
    points = np.array([point[:2] for point in points], np.float64)
    low, high = points.min(axis=0), points.max(axis=0)
    places = low + (high - low) * np.random.default_rng(1).random((count, 2))
    covered = sum(windings(points[corners], places) for corners in triangles)
    np.testing.assert_array_equal(covered, windings(points, places))
    assert (areas(points, triangles) >= 0).all()
    return triangles


def star(count, seed):
    """Returns a random star-shaped polygon."""
    random = np.random.default_rng(seed)
    angles = np.sort(random.random(count)) * 2 * math.pi
    angles = np.arange(count) / count * 2 * math.pi if np.diff(angles).max() > 3 else angles
    radii = random.random(count) + 0.1
    return [(r * math.cos(a), r * math.sin(a)) for a, r in zip(angles, radii, strict=True)]


def comb(teeth):
    """Returns a polygon with many narrow slots."""
    points = [(0, -1), (2 * teeth, -1)]
    for tooth in reversed(range(teeth)):
        points += [(2 * tooth + 2, 3), (2 * tooth + 1.01, 3), (2 * tooth + 1.005, 0.1)]
    return [*points, (0, 3)]


def spiral(turns):
    """Returns a corridor wound around the origin."""
    outer = [((k / 16 + 1) * math.cos(k / 2), (k / 16 + 1) * math.sin(k / 2)) for k in range(turns)]
    inner = [(0.93 * x, 0.93 * y) for x, y in outer]
    return outer + inner[::-1]


U = [(1, 1), (1, 3), (0, 3), (0, 0), (3, 0), (3, 3), (2, 3), (2, 1)]
RING = [
    *((0, 0), (4, 0), (4, 4), (0, 4), (0, 0)),
    *((1, 1), (1, 3), (3, 3), (3, 1), (1, 1)),
]
"""A square with a hole, joined by an edge that occurs twice."""
TWO_HOLES = [
    *((0, 0), (9, 0), (9, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1)),
    *((6, 1), (6, 3), (8, 3), (8, 1), (6, 1), (3, 1), (1, 1)),
]
"""The second hole is joined to the first, and that to the outline at one corner."""
DUMBBELL = [
    *((0, 0), (1, 0), (2, 1), (3, 0), (4, 0), (4, -1), (3, -1)),
    *((3, 0), (2, 1), (1, 0), (1, -1), (0, -1)),
]
"""Two squares that a bent line joins, which occurs twice."""
EIGHT = [(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1)]
"""Two triangles that touch at a corner."""
SHAPES = {
    "u": U,
    "ring": RING,
    "two holes": TWO_HOLES,
    "dumbbell": DUMBBELL[::-1],
    "touching": EIGHT,
    "comb": comb(20),
    "spiral": spiral(80),
    "nearly straight": [(0, 0), (1, -1e-7), (2, 0), (3, -2e-7), (4, 0), (2, 1e-3)],
    "straight": [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)],
    "spike": [(0, 0), (2, 0), (4, 0), (2, 0), (2, 2), (0, 2)],
    **{f"star {seed}": star(40, seed) for seed in range(6)},
}


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("shift", [0, 1, 5])
def test_triangles_cover_the_inside_once(name, shift):
    points = SHAPES[name]
    check(points[shift:] + points[:shift])


@pytest.mark.parametrize("name", ["u", "ring", "comb", "star 1"])
@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (0, -1, 0), (1, 2, -3), (-3, 1, 0.1)])
def test_in_any_plane(name, axis):
    """The oracle is the flat polygon, whose triangles must be the same up to their choice."""
    normal = np.array(axis) / np.linalg.norm(axis)
    across = np.cross(normal, [0.3, 0.5, 0.9])
    across /= np.linalg.norm(across)
    frame = np.stack([across, np.cross(normal, across), normal])
    flat = np.array([(x, y, 0.0) for x, y in SHAPES[name]])
    placed = (flat @ frame + [5, 7, -3]).astype(np.float32).astype(np.float64)
    triangles = triangulated(placed)
    own = areas(flat, triangles)
    x, y, _ = flat.T
    assert (own > -1e-6).all()
    assert own.sum() == pytest.approx((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def test_a_convex_polygon_is_a_fan():
    corners = [(math.cos(k), math.sin(k)) for k in range(6)]
    expected = [(0, k, k + 1) for k in range(1, 5)]
    np.testing.assert_array_equal(triangulated(corners), expected)


def test_straight_corners_leave_no_triangle_without_an_area():
    for shift in range(8):
        points = SHAPES["straight"][shift:] + SHAPES["straight"][:shift]
        triangles = triangulated(points)
        assert len(triangles) == 6
        assert (areas(points, triangles) > 0).all()


def test_each_side_is_a_side_of_one_triangle():
    """A closed surface of polygons therefore stays closed."""
    for name in ("u", "ring", "comb", "straight"):
        triangles = check(SHAPES[name])
        sides = [tuple(side) for t in triangles for side in (t[:2], t[1:], t[[2, 0]])]
        count = len(SHAPES[name])
        for k in range(count):
            assert sides.count((k, (k + 1) % count)) == 1
        assert all(sides.count(side) == 1 for side in sides)


def test_bent_quads_of_both_kinds():
    """A quad that is not flat and one whose diagonal would leave it."""
    bent = [(0, 0, 0), (3, 0, 0), (3, 1, 2), (0, 1, 0)]
    np.testing.assert_array_equal(triangulated(bent), [(0, 1, 2), (0, 2, 3)])
    arrow = [(0, 0), (2, 2), (0, 1), (-2, 2)]
    found = {tuple(sorted(corners)) for corners in check([*arrow[1:], arrow[0]]).tolist()}
    assert found == {(0, 1, 3), (1, 2, 3)}


def test_crossing_polygons_keep_their_signed_area():
    for seed in range(5):
        points = np.random.default_rng(seed).integers(0, 9, (12, 2))
        triangles = triangulated(points)
        x, y = points.T
        signed = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
        assert abs(areas(points, triangles).sum()) == pytest.approx(abs(signed))


def test_nasty_polygons():
    assert len(triangulated([(0, 0), (1, 0)])) == 0
    assert len(triangulated([(1, 1)] * 5)) == 0
    assert len(triangulated([(0, 0), (1, 0), (1, 0), (0, 1)])) == 1
    flat = triangulated([(k, k) for k in range(5)])
    np.testing.assert_allclose(areas([(k, k) for k in range(5)], flat), 0)
    for value in (math.nan, math.inf, 1e300):
        assert len(triangulated([(0, 0), (value, 0), (1, 1), (0, 1), (-1, 0.5)])) <= 3
    assert len(triangulated(U + U[:2] + U, [8, 0, 2, 8])) == 12


def test_wrong_arguments():
    points = np.zeros((3, 3))
    cases = {
        "corners: found vertex 3; there are 3": ([0, 1, 3], [3]),
        "corners: found vertex -1": ([0, 1, -1], [3]),
        "sizes: found 4 after a sum of 0; there are 3 corners": ([0, 1, 2], [4]),
        "sizes: found -1": ([0, 1, 2], [-1, 4]),
        "sizes: their sum is 2": ([0, 1, 2], [2]),
    }
    for words, (corners, sizes) in cases.items():
        with pytest.raises(ValueError, match=words):
            _native.triangulate_polygons(
                points, np.array(corners, np.int64), np.array(sizes, np.int64), None
            )


def test_many_corners_take_a_moment():
    """The area of a random star-shaped polygon follows from polar coordinates."""
    points = star(3000, 3)
    x, y = np.array(points).T
    expected = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
    assert areas(points, triangulated(points)).sum() == pytest.approx(expected)
