# SPDX-License-Identifier: GPL-3.0-or-later

"""Edges of meshes against a set of pairs."""

import numpy as np
import prefilter
import pytest


@pytest.mark.parametrize("dtype", [np.int32, np.int64])
def test_each_edge_once_and_at_its_corners(dtype):
    rng = np.random.default_rng(3)
    triangles = rng.integers(0, 30, (200, 3)).astype(dtype)
    edges = prefilter.mesh_edges(rng.normal(size=(30, 3)), triangles)
    pairs = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1), axis=-1)
    is_edge = pairs[..., 0] != pairs[..., 1]
    expected = sorted({tuple(pair) for pair in pairs[is_edge].tolist()})
    assert edges.vertices.tolist() == [list(pair) for pair in expected]
    np.testing.assert_array_equal(edges.corners == -1, ~is_edge)
    np.testing.assert_array_equal(edges.vertices[edges.corners[is_edge]], pairs[is_edge])


def test_a_tetrahedron():
    triangles = [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)]
    edges = prefilter.mesh_edges(np.eye(4, 3), triangles, threads=3)
    assert edges.vertices.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    assert edges.corners.tolist() == [[0, 3, 1], [1, 5, 2], [2, 4, 0], [4, 5, 3]]
