# SPDX-License-Identifier: GPL-3.0-or-later

"""Nearest points on meshes, against a search over samples."""

import numpy as np
import prefilter
import pytest
import solids

SPHERE = solids.sphere(1.0, 4, (0.0, 0.0, 0.0))
POINTS = np.random.default_rng(0).normal(size=(500, 3))


def test_points_of_a_sphere_are_towards_its_middle():
    triangles, weights, distances = prefilter.nearest_points(
        POINTS, SPHERE.positions, SPHERE.triangles
    )
    corners = SPHERE.positions[SPHERE.triangles[triangles]]
    found = np.einsum("ij,ijk->ik", weights, corners)
    np.testing.assert_allclose(np.linalg.norm(found - POINTS, axis=1), distances, atol=1e-12)
    radius = np.linalg.norm(POINTS, axis=1)
    np.testing.assert_allclose(distances, np.abs(radius - 1), atol=0.01)


def test_a_tree_that_is_kept_finds_the_same():
    positions = SPHERE.positions.copy()
    tree = prefilter.NearestPoints(positions, SPHERE.triangles)
    positions[:] = np.nan  # The tree has a copy.
    wanted = prefilter.nearest_points(POINTS, SPHERE.positions, SPHERE.triangles, threads=1)
    for first, second in zip(tree.find(POINTS), wanted, strict=True):
        np.testing.assert_array_equal(first, second)
    for first, second in zip(tree.find(POINTS[7:8], threads=2), wanted, strict=True):
        np.testing.assert_array_equal(first, second[7:8])


def test_a_tree_names_what_is_wrong():
    with pytest.raises(ValueError, match="triangles: triangle 0 names vertex 9, but there are"):
        prefilter.NearestPoints(np.zeros((3, 3)), [[9, 1, 2]])
    tree = prefilter.NearestPoints(SPHERE.positions, SPHERE.triangles)
    with pytest.raises(ValueError, match="points: row 1 holds inf"):
        tree.find([[0.0, 0.0, 0.0], [np.inf, 0.0, 0.0]])
    with pytest.raises(prefilter.Cancelled):
        tree.find(POINTS, progress=lambda fraction: False)
    with pytest.raises(prefilter.Cancelled):
        prefilter.NearestPoints(SPHERE.positions, SPHERE.triangles, progress=lambda fraction: False)
