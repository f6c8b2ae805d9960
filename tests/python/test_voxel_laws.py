# SPDX-License-Identifier: GPL-3.0-or-later

"""Laws that hold for octrees of all meshes."""

import time
from itertools import pairwise

import numpy as np
import prefilter
import pytest
from octrees import octrees_are_same
from solids import Solid, box, crumpled, join, random_rotation, sphere, torus

UNIT = (np.zeros(3), np.ones(3))
DEPTH = 5
N = 2**DEPTH
A, B = crumpled(1), crumpled(2).transformed(np.eye(3), (0.12, -0.07, 0.1))
EMPTY = sphere(0.3, 1, (0.5, 0.5, 0.5)).flipped()


def voxelized(solid: Solid, depth: int = DEPTH, bounds=UNIT, **options) -> prefilter.Octree:
    return prefilter.voxelize(
        solid.positions, solid.triangles, depth=depth, bounds=bounds, **options
    )


SOLIDS = {
    "closed": crumpled(3, 3),
    "open": crumpled(4, 3).without(range(40)),
    "crossing": join(A, B, sphere(0.2, 2, (0.3, 0.3, 0.3))),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_threads_do_not_change_a_bit(name):
    solid = SOLIDS[name]
    first = voxelized(solid, 7, threads=1)
    other = voxelized(B, 6, threads=1)
    dense = first.dense(6, threads=1)
    operations = ("union", "intersection", "difference")
    expected = {name: getattr(first, name)(other, threads=1) for name in operations}
    for threads in (2, 3, 7, 0):
        again = voxelized(solid, 7, threads=threads)
        assert octrees_are_same(first, again)
        assert np.array_equal(dense, again.dense(6, threads=threads))
        for operation, made in expected.items():
            assert octrees_are_same(made, getattr(first, operation)(other, threads=threads))


def test_the_order_of_triangles_hardly_matters():
    solid = crumpled(3, 3)
    order = np.random.default_rng(0).permutation(len(solid.triangles))
    shuffled = Solid(solid.positions, np.roll(solid.triangles[order], 1, axis=1))
    difference = voxelized(solid).dense() - voxelized(shuffled).dense()
    assert np.abs(difference).max() < 1e-6


def test_coarser_cells_are_means():
    octree = voxelized(A, 6)
    fine = octree.dense().astype(float)
    for depth in range(7):
        n = 2**depth
        means = fine.reshape(n, 64 // n, n, 64 // n, n, 64 // n).mean(axis=(1, 3, 5))
        assert octree.dense(depth).shape == (n, n, n)
        assert octree.dense(depth).dtype == np.float32
        assert np.abs(octree.dense(depth) - means).max() < 1e-6
        assert np.array_equal(octree.coarsened(depth).dense(), octree.dense(depth))
    assert np.abs(octree.dense(3) - voxelized(A, 3).dense()).max() < 2e-6
    # Beyond its depth an octree has no further detail.
    assert np.array_equal(octree.dense(7), np.kron(octree.dense(), np.ones((2, 2, 2))))


def test_queries_read_the_cells():
    octree = voxelized(A)
    dense = octree.dense()
    random = np.random.default_rng(0)
    points = random.random((2000, 3))
    x, y, z = np.floor(points * N).astype(int).T
    values = octree.values(points)
    assert values.dtype == np.float32
    assert np.array_equal(values, dense[x, y, z])
    expected = np.where(values > 1 - 1e-5, 1, np.where(values < 1e-5, -1, 0))
    assert np.array_equal(octree.classify(points), expected)
    assert np.array_equal(octree.values(points + 5), np.zeros(2000))
    assert np.array_equal(octree.classify(points + 5), np.full(2000, -1))
    assert set(np.unique(expected)) == {-1, 0, 1}
    assert octree.volume == pytest.approx(dense.mean(dtype=float), abs=1e-7)
    assert octree.box_occupancy((0, 0, 0), (1, 1, 1)) == pytest.approx(octree.volume, abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_boxes_are_integrals_over_the_cells(seed):
    random = np.random.default_rng(seed)
    low, high = np.sort(random.uniform(-0.2, 1.2, (2, 3)), axis=0)
    edges = np.arange(N + 1) / N
    along = [
        np.clip(np.minimum(edges[1:], b) - np.maximum(edges[:-1], a), 0, None)
        for a, b in zip(low, high, strict=True)
    ]
    octree = voxelized(A)
    expected = np.einsum("i,j,k,ijk->", *along, octree.dense().astype(float))
    found = octree.box_occupancy(low, high) * np.prod(high - low)
    assert found == pytest.approx(expected, abs=1e-7)


def test_moving_turning_and_scaling_along_with_the_bounds():
    """Scales by powers of two and moves by whole cells, which is exact."""
    octree = voxelized(A)
    moved = A.transformed(4 * np.eye(3), (8, -4, 16))
    bounds = (np.array([8.0, -4, 16]), np.array([12.0, 0, 20]))
    assert np.abs(voxelized(moved, bounds=bounds).dense() - octree.dense()).max() < 1e-6
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    turned = A.transformed(quarter, (1, 0, 0))
    expected = np.rot90(octree.dense(), 1, axes=(0, 1))
    assert np.abs(voxelized(turned).dense() - expected).max() < 1e-6
    shifted = A.transformed(np.eye(3), (2 / N, 0, -1 / N))
    expected = np.roll(octree.dense(), (2, 0, -1), axis=(0, 1, 2))
    assert np.abs(voxelized(shifted).dense() - expected).max() < 1e-6


def test_a_mirror_turns_inside_out():
    mirrored = A.transformed(np.diag([-1, 1, 1]), (1, 0, 0))
    assert voxelized(mirrored).volume == 0
    expected = voxelized(A).dense()[::-1]
    assert np.abs(voxelized(mirrored.flipped()).dense() - expected).max() < 1e-6


def test_volume_does_not_depend_on_how_a_solid_lies():
    for seed in range(5):
        turned = Solid(A.positions - 0.5, A.triangles).transformed(random_rotation(seed), [0.5] * 3)
        assert voxelized(turned, 6).volume == pytest.approx(A.volume, abs=1e-6)


def test_memory_follows_the_surface():
    counts = [voxelized(A, depth).node_count for depth in (6, 7, 8)]
    for coarse, fine in pairwise(counts):
        assert 3 < fine / coarse < 4.6
    octree = voxelized(A, 8)
    assert octree.nbytes < 12 * octree.node_count


@pytest.fixture(scope="module")
def pair():
    return voxelized(A), voxelized(B)


def away_from_ties(*values: np.ndarray) -> np.ndarray:
    """Cells that two surfaces share and where the result is 1/2 are moved off it, on purpose."""
    return np.all([np.abs(value - 0.5) > 2e-4 for value in values], axis=0)


def test_set_operations_are_cell_by_cell(pair):
    (a, b), (x, y) = pair, (octree.dense() for octree in pair)
    expected = {
        "union": np.maximum(x, y),
        "intersection": np.minimum(x, y),
        "difference": np.minimum(x, 1 - y),
    }
    for operation, values in expected.items():
        found = getattr(a, operation)(b).dense()
        assert np.array_equal(found[away_from_ties(values)], values[away_from_ties(values)])
        assert np.abs(found - values).max() <= 1.1e-4


def test_set_laws(pair):
    a, b = pair
    x = a.dense()
    ordinary = away_from_ties(x)
    nothing = voxelized(EMPTY)
    assert nothing.volume == 0
    for found in (a.union(a), a.intersection(a), a.union(nothing), a.difference(nothing)):
        assert np.array_equal(found.dense()[ordinary], x[ordinary])
    assert a.intersection(nothing).volume == 0
    assert a.intersection(nothing).node_count == 1
    assert nothing.difference(a).volume == 0
    for operation in ("union", "intersection"):
        ab, ba = getattr(a, operation)(b), getattr(b, operation)(a)
        assert octrees_are_same(ab, ba)
        again = getattr(ab, operation)(b)
        assert np.array_equal(again.dense(), ab.dense())
    # Absorption.
    assert np.array_equal(a.union(a.intersection(b)).dense()[ordinary], x[ordinary])
    assert np.array_equal(a.intersection(a.union(b)).dense()[ordinary], x[ordinary])


def test_de_morgan(pair):
    """The complement of a union is the intersection of the complements."""
    a, b = pair
    everything = voxelized(sphere(9.0, 1))
    assert (everything.dense() == 1).all()
    left = everything.difference(a.union(b)).dense()
    right = everything.difference(a).intersection(everything.difference(b)).dense()
    assert np.abs(left - right)[away_from_ties(left)].max() < 1e-7
    twice = everything.difference(everything.difference(a)).dense()
    assert np.abs(twice - a.dense())[away_from_ties(twice)].max() < 1e-7


@pytest.mark.parametrize("depths", [(3, 6), (6, 3), (1, 5)])
def test_operands_of_different_depths(depths):
    """Coarse cells are split, and keep their occupancies; the rest is cell by cell."""
    a, b = (voxelized(s, d) for s, d in zip((A, B), depths, strict=True))
    speck = voxelized(sphere(0.01, 1, (0.99, 0.99, 0.99)), max(depths))
    fine = [octree.union(speck).difference(speck) for octree in (a, b)]
    for octree, split in zip((a, b), fine, strict=True):
        off = np.abs(split.dense(octree.depth) - octree.dense())
        corner = slice(int(0.98 * len(off)), None)
        off[corner, corner, corner] = 0  # where the speck was
        assert off.max() < 1e-6
    x, y = (split.dense() for split in fine)
    for operation, values in (
        ("union", np.maximum(x, y)),
        ("intersection", np.minimum(x, y)),
        ("difference", np.minimum(x, 1 - y)),
    ):
        found = getattr(a, operation)(b)
        assert found.depth == max(depths)
        off = np.abs(found.dense() - values)
        n = 2 ** (max(depths) - min(depths))
        off[-n:, -n:, -n:] = 0
        assert off.max() <= 1.1e-4


def test_a_plane_in_coarse_cells_is_one_in_fine_cells():
    """United with a fine ball, a half-space has the occupancies that its mesh has in fine cells."""
    half = box((-2.0, -2.0, -3.0), (2.0, 2.0, 0.0)).transformed(
        random_rotation(4), (0.5, 0.45, 0.5)
    )
    ball = voxelized(sphere(0.05, 3, (0.1, 0.1, 0.1)), 6)
    joined = voxelized(half, 4).union(ball).dense()
    expected = voxelized(half, 6).union(ball).dense()
    # Beyond the root all is empty, so the plane ends there.
    within = slice(12, -12)
    off = np.abs(joined - expected)[within, within, within]
    assert off.max() < 1e-3
    assert (expected[within, within, within] > 0).any()


def test_operands_of_other_bounds():
    """The second grid is the first one moved by whole cells: values carry over exactly."""
    a = voxelized(A)
    low = np.array([4, -8, 12]) / N
    b = voxelized(B, 4, (low, low + 0.5))
    y = np.zeros((N + 32,) * 3, np.float32)
    y[20:36, 8:24, 28:44] = b.dense()
    y = y[16 : 16 + N, 16 : 16 + N, 16 : 16 + N]
    x = a.dense()
    for operation, values in (
        ("intersection", np.minimum(x, y)),
        ("difference", np.minimum(x, 1 - y)),
    ):
        found = getattr(a, operation)(b)
        assert found.bounds == a.bounds
        assert np.abs(found.dense() - values).max() <= 1.1e-4


def test_a_union_grows_to_hold_both():
    left = voxelized(sphere(0.3, 3, (0.5, 0.5, 0.5)))
    far = sphere(0.3, 3, (3.21, -0.4, 0.5))
    right = voxelized(far, 5, (np.array([2.7, -0.9, 0]), np.array([3.7, 0.1, 1])))
    for first, second in ((left, right), (right, left)):
        both = first.union(second)
        low, high = (np.array(corner) for corner in both.bounds)
        assert (low <= [0.2, -0.7, 0.2]).all()
        assert (high >= [3.51, 0.8, 0.8]).all()
        assert both.volume == pytest.approx(left.volume + right.volume, rel=1e-5)


def test_bounds_that_share_no_corner_keep_the_volume():
    a = voxelized(A, 6, (np.full(3, -0.137), np.full(3, 1.211)))
    b = voxelized(sphere(0.2, 4, (0.5, 0.5, 0.5)), 6, (np.full(3, 0.1), np.full(3, 0.93)))
    inside = a.intersection(b)
    full = voxelized(sphere(0.2, 4, (0.5, 0.5, 0.5)), 6).intersection(voxelized(A, 6))
    assert inside.volume == pytest.approx(full.volume, rel=2e-3)


def test_progress_rises_to_one():
    seen = []
    octree = voxelized(A, 7, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    seen.clear()
    octree.union(voxelized(B, 7), progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_returning_false_stops_soon():
    """Cancels at any time within 0.2 s of processor time, or twice that on a busy machine."""
    solid = torus(0.3, 0.15, 200, 100).transformed(random_rotation(1), (0.5, 0.5, 0.5))
    for share in (0.0, 0.3, 0.7):
        stopped = []

        def stop(fraction, share=share, stopped=stopped):
            if fraction >= share:
                stopped.append(time.process_time())
                return False
            return True

        with pytest.raises(prefilter.Cancelled):
            voxelized(solid, 10, progress=stop, threads=1)
        assert len(stopped) == 1
        assert time.process_time() - stopped[0] < 0.4


def test_nasty_meshes_that_are_fine():
    one = voxelized(
        Solid(np.array([(0.2, 0.2, 0.5), (0.8, 0.2, 0.5), (0.5, 0.8, 0.5)]), [[0, 1, 2]])
    )
    assert np.isfinite(one.dense()).all()
    solid = box((0.2,) * 3, (0.7,) * 3)
    flat = np.array([[0, 0, 0], [1, 1, 3], [0, 3, 3]])
    duplicated = Solid(solid.positions, np.concatenate([solid.triangles, solid.triangles]))
    with_flat = Solid(solid.positions, np.concatenate([flat, solid.triangles]))
    unused = Solid(np.concatenate([solid.positions, np.full((3, 3), 1e9)]), solid.triangles)
    expected = voxelized(solid).dense()
    assert np.array_equal(voxelized(with_flat).dense(), expected)
    assert np.array_equal(voxelized(unused).dense(), expected)
    assert np.abs(voxelized(duplicated).dense() - np.clip(2 * expected, 0, 1)).max() < 2e-6
    huge = solid.transformed(1e150 * np.eye(3))
    found = voxelized(huge, bounds=(np.zeros(3), np.full(3, 1e150)))
    assert np.abs(found.dense() - expected).max() < 2e-6


@pytest.mark.parametrize(("depth", "margin"), [(1, 0.25), (2, 0.5), (3, 1), (4, 2), (8, 2)])
def test_the_cube_around_a_box(depth, margin):
    corners = np.array([[-1.0, 0, 2], [0, 2, 2], [-1, 1, 6]])
    box = corners.min(axis=0), corners.max(axis=0)
    cells = 1 << depth
    low, high = prefilter.cube_around(box, depth=depth)
    np.testing.assert_allclose(high - low, 4 * cells / (cells - 2 * margin), rtol=1e-14)
    np.testing.assert_allclose((low + high) / 2, [-0.5, 1, 4], rtol=1e-14)
    tree = prefilter.voxelize(corners, [[0, 1, 2]], depth=depth)
    np.testing.assert_array_equal(tree.bounds, (low, high))
