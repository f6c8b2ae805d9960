# SPDX-License-Identifier: GPL-3.0-or-later

"""Borders of the area covered by a UV map, against brute force."""

import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def borders(addon):
    return addon("bridge.uv_layouts").borders


def winding(polygons, points):
    """Returns how often polygons wind around points."""
    found = np.zeros(len(points))
    for polygon in polygons:
        a = polygon[None] - points[:, None]
        b = np.roll(a, -1, axis=1)
        cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        found += np.arctan2(cross, (a * b).sum(axis=-1)).sum(axis=1) / (2 * np.pi)
    return np.rint(found)


def covering(triangles, points):
    """Returns how many triangles cover each point."""
    found = np.zeros(len(points))
    for triangle in triangles.astype(float):
        a = triangle[None] - points[:, None]
        b = np.roll(a, -1, axis=1)
        cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        found += (cross > 0).all(axis=1) | (cross < 0).all(axis=1)
    return found


@pytest.mark.parametrize("seed", range(5))
def test_borders_wind_once_for_each_triangle(borders, seed):
    rng = np.random.default_rng(seed)
    corners = rng.integers(0, 7, (40, 2)).astype(np.float32) / 6
    triangles = corners[rng.integers(0, len(corners), (30, 3))]
    points = rng.random((400, 2))
    np.testing.assert_array_equal(winding(borders(triangles), points), covering(triangles, points))


def test_inner_edges_are_gone(borders):
    side = 20
    place = np.stack(np.meshgrid(*[np.arange(side + 1) / side] * 2), axis=-1).astype(np.float32)
    a, b, c, d = place[:-1, :-1], place[:-1, 1:], place[1:, 1:], place[1:, :-1]
    halves = [np.stack(one, axis=-2).reshape(-1, 3, 2) for one in ((a, b, c), (a, d, c))]
    triangles = np.concatenate(halves)
    (polygon,) = borders(triangles)
    assert len(polygon) == 4 * side


def test_nasty(borders):
    assert borders(np.zeros((0, 3, 2), np.float32)) == []
    assert borders(np.zeros((3, 3, 2), np.float32)) == []
    line = np.array([[(0, 0), (1, 1), (2, 2)]], np.float32)
    assert borders(line) == []
    twice = np.array([[(0, 0), (1, 0), (0, 1)], [(-0.0, 0), (0, 1), (1, -0.0)]], np.float32)
    assert winding(borders(twice), np.array([[0.2, 0.2]])) == [2]


def test_the_active_map_with_modifiers(addon):
    obj = scenes.quads("Quad", [[(0, 0), (0.5, 0), (0.5, 0.5), (0, 0.5)]])
    scenes.add_uv_map(obj.data, "Other", [scenes.UNIT_SQUARE])
    read = addon("bridge.uv_layouts").read_layout
    obj.data.uv_layers.active = obj.data.uv_layers["Other"]
    assert np.ptp(read(obj, scenes.depsgraph())[0]) == 1.0
    obj.data.uv_layers.active = obj.data.uv_layers["UVMap"]
    assert np.ptp(read(obj, scenes.depsgraph())[0]) == 0.5
    bpy.ops.object.mode_set(mode="EDIT")
    assert np.ptp(read(obj, scenes.depsgraph())[0]) == 0.5
