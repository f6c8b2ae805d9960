# SPDX-License-Identifier: GPL-3.0-or-later

"""Normals of points: eigenvectors by numpy, surfaces whose normals are known, and nasty points."""

import numpy as np
import prefilter
import pytest
import solids
from clouds import sphere, torus

KITTEN = solids.DATA.parent / "points" / "kitten.xyz"
RANDOM = np.random.default_rng(0)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def box(count, sides=(1.0, 1.0, 1.0)):
    areas = np.prod(sides) / np.array(sides)
    axes = RANDOM.choice(3, count, p=areas / areas.sum())
    ends = RANDOM.integers(0, 2, count)
    points = RANDOM.random((count, 3))
    points[np.arange(count), axes] = ends
    normals = np.zeros((count, 3))
    normals[np.arange(count), axes] = 2 * ends - 1
    return points * sides, normals


def join(*clouds):
    return tuple(np.concatenate(parts) for parts in zip(*clouds, strict=True))


def degrees(found, wanted):
    return np.degrees(np.arccos(np.clip(np.sum(found * wanted, axis=1), -1, 1)))


def slow_normals(points, neighbours):
    """Normals by exhaustive search and numpy's eigenvectors, of either sign."""
    normals = []
    for point in points:
        squares = np.sum((points - point) ** 2, axis=1)
        nearest = np.argsort(squares, kind="stable")[:neighbours]
        weights = 1 - squares[nearest] / (2 * squares[nearest[-1]])
        normals.append(np.linalg.eigh(np.cov(points[nearest].T, aweights=weights))[1][:, 0])
    return np.array(normals)


@pytest.mark.parametrize("neighbours", [12, 16, 50])
def test_they_are_eigenvectors_of_the_covariance(neighbours):
    points, _ = torus(700).both
    found = prefilter.estimate_normals(points, neighbours=neighbours)
    wanted = slow_normals(points, neighbours)
    np.testing.assert_allclose(np.abs(np.sum(found * wanted, axis=1)), 1, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=1e-12)


@pytest.mark.parametrize(
    ("cloud", "most"),
    [
        (sphere(20_000).both, 4),
        (torus(20_000).both, 8),
        (sphere(20_000, radius=3e-9, center=(5e-7, 0, 1e-7)).both, 4),
        (sphere(20_000, radius=1e140).both, 4),
        (join(sphere(8_000).both, sphere(8_000, 0.5, (3, 0, 0)).both), 6),
    ],
    ids=["sphere", "torus", "small sphere", "large sphere", "two spheres"],
)
def test_smooth_closed_surfaces(cloud, most):
    points, normals = cloud
    errors = degrees(prefilter.estimate_normals(points), normals)
    assert errors.max() < most


def test_box():
    points, normals = box(20_000)
    errors = degrees(prefilter.estimate_normals(points), normals)
    # Along the edges there are neighbors around the corner.
    inside = np.sum(np.minimum(points, 1 - points) < 0.08, axis=1) == 1
    assert errors[inside].max() < 1e-4
    assert errors.max() < 90


def test_faces_apart_from_each_other():
    points, normals = box(20_000)
    kept = np.sum(np.minimum(points, 1 - points) < 0.1, axis=1) == 1
    errors = degrees(prefilter.estimate_normals(points[kept]), normals[kept])
    assert errors.max() < 1e-4


def test_noise():
    points, normals = torus(20_000).both
    noisy = points + RANDOM.normal(scale=0.01, size=points.shape)
    errors = degrees(prefilter.estimate_normals(noisy, neighbours=32), normals)
    assert errors.max() < 60
    assert errors.mean() < 9


def test_uneven_density():
    points, normals = sphere(60_000).both
    kept = RANDOM.random(len(points)) < np.where(points[:, 0] > 0, 1, 1 / 30)
    errors = degrees(prefilter.estimate_normals(points[kept]), normals[kept])
    assert errors.max() < 25


def test_a_sheet_thicker_than_its_neighborhoods():
    points, normals = box(60_000, (1.0, 1.0, 0.05))
    errors = degrees(prefilter.estimate_normals(points), normals)
    assert np.mean(errors < 90) > 0.999


def test_a_plane_has_two_sides():
    points = np.concatenate([RANDOM.random((500, 2)), np.full((500, 1), 0.25)], axis=1)
    normals = prefilter.estimate_normals(points)
    np.testing.assert_allclose(normals, np.broadcast_to([0, 0, normals[0, 2]], (500, 3)), atol=1e-9)
    assert abs(normals[0, 2]) == pytest.approx(1)


def test_lines_of_a_scan():
    # Twenty times as dense along the lines as across them.
    x, y = np.meshgrid(np.linspace(0, 1, 400), np.linspace(0, 1, 21))
    points = np.stack([x, y, 0.1 * np.sin(3 * x + 2 * y)], axis=-1).reshape(-1, 3)
    slope = 0.1 * np.cos(3 * x + 2 * y)
    normals = unit(np.stack([-3 * slope, -2 * slope, 1 + 0 * x], axis=-1)).reshape(-1, 3)
    found = prefilter.estimate_normals(points, viewpoint=(0.5, 0.5, 9.0))
    assert degrees(found, normals).max() < 5


def test_viewpoints():
    points, normals = sphere(3000).both
    inside = prefilter.estimate_normals(points, viewpoint=(0.1, 0.2, 0.0))
    assert degrees(inside, -normals).max() < 10
    outside = prefilter.estimate_normals(points, viewpoint=2 * points)
    assert degrees(outside, normals).max() < 10
    np.testing.assert_array_equal(inside, -outside)


def test_threads_and_order_change_nothing():
    points, _ = torus(20_000).both
    points += RANDOM.normal(scale=0.02, size=points.shape)
    one = prefilter.estimate_normals(points, threads=1)
    np.testing.assert_array_equal(one, prefilter.estimate_normals(points, threads=5))
    order = RANDOM.permutation(len(points))
    np.testing.assert_array_equal(one[order], prefilter.estimate_normals(points[order]))


def test_outliers_do_not_turn_the_surface():
    points, normals = sphere(20_000).both
    outliers = RANDOM.uniform(-1.2, 1.2, (400, 3))
    found = prefilter.estimate_normals(np.concatenate([points, outliers]))
    assert np.mean(degrees(found[: len(points)], normals) < 90) > 0.999


def test_copies_have_the_normal_of_one():
    points, _ = sphere(2000).both
    copies = np.concatenate([points, np.repeat(points[:40], 50, axis=0)])
    found = prefilter.estimate_normals(copies)
    np.testing.assert_array_equal(found[: len(points)], prefilter.estimate_normals(points))
    np.testing.assert_array_equal(found[len(points) :], np.repeat(found[:40], 50, axis=0))


def test_points_on_a_line_have_normals_across_it():
    points = np.linspace(0, 1, 300)[:, None] * [1.0, 2.0, 3.0]
    normals = prefilter.estimate_normals(points)
    np.testing.assert_allclose(normals @ [1.0, 2.0, 3.0], 0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)


def test_points_that_are_not_finite_have_no_normal():
    points, normals = sphere(2000).both
    bad = points.copy()
    bad[[3, 50, 700]] = [(np.nan, 0, 0), (0, np.inf, 0), (0, 0, -1e200)]
    found = prefilter.estimate_normals(bad)
    assert not found[[3, 50, 700]].any()
    rest = np.delete(np.arange(2000), [3, 50, 700])
    np.testing.assert_array_equal(found[rest], prefilter.estimate_normals(points[rest]))
    assert degrees(found[rest], normals[rest]).max() < 10


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((1, 3)),
        np.array([[0.0, 0, 0], [1, 0, 0]]),
        np.zeros((100, 3)),
        np.full((5, 3), np.nan),
        np.array([[0.0, 0, 0], [1, 0, 0], [np.nan, 0, 0], [1, 0, 0]]),
        1e-170 * RANDOM.random((50, 3)),
    ],
    ids=["one", "two", "one place", "not finite", "two of four", "squares vanish"],
)
def test_too_few_points_have_none(points):
    assert not prefilter.estimate_normals(points).any()


def test_three_points_have_the_normal_of_their_plane():
    found = prefilter.estimate_normals(np.array([[0.0, 0, 2], [1, 0, 2], [0, 1, 2]]))
    np.testing.assert_allclose(np.abs(found), np.broadcast_to([0, 0, 1.0], (3, 3)), atol=1e-9)


def test_single_precision_input():
    points, normals = sphere(2000).both
    assert degrees(prefilter.estimate_normals(points.astype(np.float32)), normals).max() < 10


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"neighbours": 2}, "neighbours: found 2; a number from 3 to 1000"),
        ({"neighbours": 1001}, "neighbours: found 1001; a number from 3 to 1000"),
        ({"neighbours": 8.5}, "neighbours: 8.5; a whole number from 3 to 1000"),
        ({"viewpoint": [0.0, 1.0]}, r"viewpoint: shape \(2,\); \(3\,?\) is needed"),
        ({"viewpoint": [0.0, np.nan, 1.0]}, "viewpoint: row 0 holds nan"),
        ({"viewpoint": np.zeros((2, 3))}, "viewpoint: found 2 for 5 points; one for all or one"),
        ({"viewpoint": np.zeros((0, 3))}, r"viewpoint: shape \(0, 3\); one for all points or one"),
        ({"viewpoint": "above"}, "viewpoint: "),
        ({"viewpoint": [[0.0], [1.0, 2.0]]}, "viewpoint: "),
        ({"threads": -1}, "threads: -1"),
        ({"points": np.zeros((0, 3))}, "points: none; at least one"),
        ({"points": np.zeros((4, 2))}, r"points: shape \(4, 2\)"),
        ({"points": np.zeros((4, 3), bool)}, "points: dtype bool"),
    ],
)
def test_what_is_wrong_is_named(options, message):
    arguments = {"points": np.zeros((5, 3)), **options}
    with pytest.raises(ValueError, match=message):
        prefilter.estimate_normals(arguments.pop("points"), **arguments)


@pytest.mark.skipif(not KITTEN.exists(), reason="the model is not there")
def test_a_scanned_model_with_normals():
    rows = np.loadtxt(KITTEN)
    errors = degrees(prefilter.estimate_normals(rows[:, :3]), unit(rows[:, 3:6]))
    assert errors.max() < 90
    assert errors.mean() < 6
