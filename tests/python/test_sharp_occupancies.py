# SPDX-License-Identifier: GPL-3.0-or-later

"""Edges and corners that occupancies fix by themselves, without the meshes that they come from."""

from itertools import product

import numpy as np
import prefilter
import pytest
from solids import Solid, box, join, random_rotation, sphere, surface_faults

DEPTH = 6
UNIT = (np.zeros(3), np.ones(3))


def edge_points(side: float) -> np.ndarray:
    """Along the edges of a cube around the origin."""
    along = np.linspace(-side / 2, side / 2, 200)
    points = []
    for axis in range(3):
        for u, v in product((-side / 2, side / 2), repeat=2):
            edge = np.empty((len(along), 3))
            edge[:, axis] = along
            edge[:, axis - 1], edge[:, axis - 2] = u, v
            points.append(edge)
    return np.concatenate(points)


def turned(points: np.ndarray, seed: int) -> np.ndarray:
    return points @ random_rotation(seed).T + 0.5


def sharp_contour(solid: Solid, **options) -> tuple[np.ndarray, np.ndarray]:
    octree = prefilter.voxelize(solid.positions, solid.triangles, depth=DEPTH, bounds=UNIT)
    return octree.contour(interpolant="sharp", cleanup=False, **options)


def facets(positions: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normals and areas."""
    corners = positions[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    return normals / lengths[:, None], lengths / 2


@pytest.mark.parametrize("seed", range(4))
def test_a_turned_cube_has_its_edges(seed):
    cube = box((-0.3,) * 3, (0.3,) * 3).transformed(random_rotation(seed), (0.5,) * 3)
    positions, triangles = sharp_contour(cube)
    assert surface_faults(positions, triangles).none
    missed = prefilter.nearest_points(turned(edge_points(0.6), seed), positions, triangles)[2]
    missed *= 2**DEPTH
    assert missed.mean() < 0.02
    assert np.quantile(missed, 0.95) < 0.1
    normals, areas = facets(positions, triangles)
    cosines = np.abs(normals @ random_rotation(seed)).max(axis=1)
    off = np.degrees(np.arccos(cosines.clip(-1, 1))) > 10
    assert areas[off].sum() < 0.003 * areas.sum()


def test_a_notch_is_as_sharp_as_an_edge():
    """A smaller cube taken out of the corner of a larger one: edges inwards, and a corner."""
    rotation = random_rotation(3)
    outer = box((-0.3,) * 3, (0.3,) * 3).transformed(rotation, (0.5,) * 3)
    notch = box((0.0,) * 3, (0.5,) * 3).transformed(rotation, (0.5,) * 3)
    a, b = (
        prefilter.voxelize(s.positions, s.triangles, depth=DEPTH, bounds=UNIT)
        for s in (outer, notch)
    )
    positions, triangles = a.difference(b).contour(interpolant="sharp", cleanup=False)
    assert surface_faults(positions, triangles).none
    along = np.linspace(0.0, 0.3, 100)
    inner = np.concatenate([np.outer(along, axis) for axis in np.eye(3)])
    missed = prefilter.nearest_points(turned(inner, 3), positions, triangles)[2] * 2**DEPTH
    assert missed.mean() < 0.02
    assert np.quantile(missed, 0.95) < 0.1


def test_what_is_smooth_gets_no_edges():
    balls = join(sphere(0.2, 5, (0.27, 0.3, 0.3)), sphere(0.22, 5, (0.7, 0.68, 0.7)))
    octree = prefilter.voxelize(balls.positions, balls.triangles, depth=DEPTH, bounds=UNIT)
    plane = octree.contour(interpolant="plane", cleanup=False)
    for found, expected in zip(sharp_contour(balls), plane, strict=True):
        assert np.array_equal(found, expected)


def test_threads_do_not_change_edges():
    cube = box((-0.3,) * 3, (0.3,) * 3).transformed(random_rotation(1), (0.5,) * 3)
    first = sharp_contour(cube, threads=1)
    for threads in (2, 5):
        for one, other in zip(first, sharp_contour(cube, threads=threads), strict=True):
            assert np.array_equal(one, other)
