# SPDX-License-Identifier: GPL-3.0-or-later

"""Lost parts, against distances from the resulting surface, measured one by one."""

import numpy as np
import prefilter
import pytest
from solids import box, join, random_rotation, sheet, sphere

from bench.voxels.nearest import Nearest

DEPTH = 6
CELLS = 2**DEPTH
BOUNDS = (np.zeros(3), np.full(3, float(CELLS)))


def voxelized(solid, **options):
    return prefilter.voxelize(
        solid.positions, solid.triangles, depth=DEPTH, bounds=BOUNDS, **options
    )


def lost_parts(solid, tree, threads=0):
    parts = prefilter.mesh_topology(solid.positions, solid.triangles).part_of
    return tree.lost_parts(solid.positions, solid.triangles, parts, threads=threads).tolist()


def is_within(points, corners):
    """Returns whether points are inside, by solid angles (van Oosterom and Strackee 1983)."""
    a, b, c = (corners[None, :, k] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(one, axis=-1) for one in (a, b, c))
    det = (a * np.cross(b, c)).sum(-1)
    below = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
    return np.arctan2(det, below).sum(axis=1) / (2 * np.pi) > 0.5


def grid_on(corners, spacing=0.2):
    """Returns points spread over triangles."""
    points = []
    for a, b, c in corners:
        n = int(np.ceil(max(np.linalg.norm(b - a), np.linalg.norm(c - a)) / spacing)) + 1
        u, v = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
        keep = u + v <= 1 + 1e-9
        points.append(a + u[keep, None] * (b - a) + v[keep, None] * (c - a))
    return np.concatenate(points)


def specks(seed):
    """Boxes with sides of 0.1 to 2.5 cells, some of them near a large one."""
    rng = np.random.default_rng(seed)
    parts = [box((20, 20, 20), (40, 40, 40))]
    for _ in range(40):
        half = rng.uniform(0.05, 1.25, 3)
        middle = rng.uniform(6, 58, 3)
        if rng.random() < 0.4:
            middle[rng.integers(3)] = rng.choice([20, 40]) + rng.uniform(-3, 3)
        parts.append(box(-half, half).transformed(random_rotation(int(rng.integers(99))), middle))
    return join(*parts)


@pytest.mark.parametrize("seed", range(3))
def test_lost_is_what_is_far_from_the_surface(seed):
    pytest.importorskip("scipy", reason="scipy finds nearest triangles")
    solid = specks(seed)
    tree = voxelized(solid)
    positions, triangles = tree.contour(
        interpolant="sharp", sources=[(solid.positions, solid.triangles)]
    )
    surface = positions[triangles]
    nearest = Nearest(surface)
    part_of = prefilter.mesh_topology(solid.positions, solid.triangles).part_of
    expected, unclear = [], []
    for part in range(part_of.max() + 1):
        points = grid_on(solid.positions[solid.triangles[part_of == part]])
        near = 0.0 if is_within(points[:1], surface)[0] else nearest.distances(points).min()
        if near > 1.0:
            expected.append(part)
        if abs(near - 1.0) < 0.1:
            unclear.append(part)
    found = lost_parts(solid, tree)
    assert set(found) - set(unclear) == set(expected) - set(unclear)
    assert len(expected) > 5
    assert len(unclear) < 4
    assert lost_parts(solid, tree, threads=1) == found


def test_what_is_thickened_is_kept():
    for seed in range(3):
        solid = specks(seed)
        assert lost_parts(solid, voxelized(solid, thickness=1.5)) == []


def test_inside_of_another_part_nothing_is_lost():
    """The surface passes far from a part that lies inside a solid."""
    solid = join(sphere(25.0, 4, (32, 32, 32)), box((31, 31, 31), (31.2, 31.2, 31.2)))
    assert lost_parts(solid, voxelized(solid)) == []


def test_sheets_are_lost_unless_they_are_thickened():
    flat = sheet(8, lambda x, y: 0 * x).transformed(20 * np.eye(3), np.full(3, 32.4))
    both = join(flat, box((2, 2, 2), (9, 9, 9)))
    assert lost_parts(both, voxelized(both)) == [0]
    solid = prefilter.as_solid(both.positions, both.triangles, cell=1.0, sheets="faces")
    tree = prefilter.voxelize(
        solid.positions, solid.triangles, depth=DEPTH, bounds=BOUNDS, thickness=1.5
    )
    assert lost_parts(both, tree) == []


def test_all_is_lost():
    solid = box((30.4, 30.4, 30.4), (30.5, 30.5, 30.5))
    assert lost_parts(solid, voxelized(solid)) == [0]


def test_beyond_the_bounds_nothing_is_lost():
    solid = join(box((70, 0, 0), (70.1, 1, 1)), box((2, 2, 2), (9, 9, 9)))
    assert lost_parts(solid, voxelized(solid)) == []


def test_numbers_of_parts_may_have_gaps():
    solid = join(box((30.4, 30.4, 30.4), (30.5, 30.5, 30.5)), box((2, 2, 2), (9, 9, 9)))
    part_of = np.repeat([7, 3], 12)
    part_of[1] = -1
    tree = voxelized(solid)
    assert tree.lost_parts(solid.positions, solid.triangles, part_of).tolist() == [7]
    none = np.full(24, -1)
    assert tree.lost_parts(solid.positions, solid.triangles, none).tolist() == []
