# SPDX-License-Identifier: GPL-3.0-or-later

"""Occupancies against exact integrals by another method, and analytic solids."""

import numpy as np
import prefilter
import pytest
from solids import (
    Solid,
    box,
    crumpled,
    join,
    mesh_volume,
    occupancies,
    pieces,
    random_rotation,
    sphere,
    torus,
)

UNIT = (np.zeros(3), np.ones(3))
ROUNDING = 2e-6


def voxelized(solid: Solid, depth: int, bounds=UNIT, **options) -> prefilter.Octree:
    return prefilter.voxelize(
        solid.positions, solid.triangles, depth=depth, bounds=bounds, **options
    )


def check(solid: Solid, depth: int, bounds=UNIT) -> None:
    found = voxelized(solid, depth, bounds).dense()
    expected = np.clip(occupancies(solid, *bounds, 2**depth), 0, 1)
    assert np.abs(found - expected).max() < ROUNDING


@pytest.mark.parametrize("depth", [1, 2, 3, 4, 5])
def test_a_closed_mesh_has_its_exact_occupancy(depth):
    check(crumpled(depth), depth)


@pytest.mark.parametrize("seed", range(6))
def test_any_closed_mesh(seed):
    """Slivers, and dents deeper than a cell."""
    check(crumpled(seed, rounds=1 + seed % 3, strength=0.8), 4)


def test_cells_are_boxes_where_the_bounds_are():
    bounds = (np.array([0.1, -0.2, 0.3]), np.array([0.9, 1.4, 0.8]))
    check(crumpled(1), 4, bounds)


def test_what_leaves_the_bounds_is_cut_off():
    """Parts lie outside on all sides, so every estimate of the root's mean is affected."""
    solid = crumpled(3)
    for low, high in ((0.3, 0.6), (0.5, 1.2), (-0.4, 0.45)):
        check(solid, 3, (np.full(3, low), np.full(3, high)))
    check(solid, 3, (np.array([0.3, -1, 0.5]), np.array([0.7, 2, 3])))


def test_a_mesh_that_is_all_around_fills_the_bounds():
    octree = voxelized(sphere(9.0, 1), 3)
    assert (octree.dense() == 1).all()
    assert octree.node_count == 1 or octree.volume == 1


@pytest.mark.parametrize("depth", [3, 5])
def test_a_box_analytically(depth):
    low, high = np.array([0.13, 0.25, 0.4]), np.array([0.88, 0.77, 0.4371])
    edges = np.arange(2**depth + 1) / 2**depth

    def shares(a, b):
        return np.clip(np.minimum(edges[1:], b) - np.maximum(edges[:-1], a), 0, None) * 2**depth

    expected = np.einsum("i,j,k->ijk", *(shares(a, b) for a, b in zip(low, high, strict=True)))
    octree = voxelized(box(low, high), depth)
    assert np.abs(octree.dense() - expected).max() < ROUNDING


@pytest.mark.parametrize("cut", [0.25, 0.5, 0.3125])
def test_faces_on_the_borders_of_cells(cut):
    """A face on a border of cells belongs to one side of it, so no cell is half inside."""
    octree = voxelized(box((cut,) * 3, (0.75,) * 3), 4)
    expected = np.zeros((16, 16, 16))
    first = round(cut * 16)
    expected[first:12, first:12, first:12] = 1
    assert np.array_equal(octree.dense(), expected)


def test_a_fine_torus():
    """The volumes of the torus and of its mesh differ by the volume that chords cut off."""
    solid = torus(0.27, 0.11, 96, 64).transformed(random_rotation(4), (0.5, 0.5, 0.5))
    check(solid, 4)
    octree = voxelized(solid, 6)
    exact = 2 * np.pi**2 * 0.27 * 0.11**2
    assert octree.volume == pytest.approx(solid.volume, abs=1e-6)
    assert octree.volume == pytest.approx(exact, rel=4e-3)


def test_a_fine_sphere():
    """Leaves far from the surface hold exactly 0 or 1."""
    solid = sphere(0.41, 6, (0.5, 0.49, 0.52))
    check(solid, 4)
    octree = voxelized(solid, 7)
    middles = (np.stack(np.meshgrid(*[np.arange(128)] * 3, indexing="ij"), -1) + 0.5) / 128
    distance = np.linalg.norm(middles - (0.5, 0.49, 0.52), axis=-1) - 0.41
    far = np.abs(distance) > 0.5 * np.sqrt(3) / 128 + 1e-3
    assert np.array_equal(octree.dense()[far], (distance < 0)[far])


@pytest.mark.parametrize("depth", [2, 6, 9])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_sum_of_the_cells_is_the_volume(seed, depth):
    solid = crumpled(seed)
    octree = voxelized(solid, depth)
    assert octree.volume == pytest.approx(solid.volume, abs=1e-6)
    if depth < 9:
        assert octree.dense().mean(dtype=float) == pytest.approx(solid.volume, abs=1e-6)


def test_default_bounds_hold_the_mesh_with_two_cells_to_spare():
    solid = crumpled(2).transformed(np.diag([3.0, 1.0, 7.0]), (100, -20, 5))
    octree = prefilter.voxelize(solid.positions, solid.triangles, depth=6)
    low, high = (np.array(corner) for corner in octree.bounds)
    cell = (high - low) / 64
    assert np.allclose(cell, cell[0], rtol=1e-12)
    assert (solid.positions.min(axis=0) - low >= 2 * cell - 1e-9).all()
    assert (high - solid.positions.max(axis=0) >= 2 * cell - 1e-9).all()
    assert np.prod(high - low) * octree.dense().mean(dtype=float) == pytest.approx(
        solid.volume, rel=1e-5
    )


def test_overlaps_count_once_and_the_inside_out_not_at_all():
    """Cells hold the mean winding number, clamped."""
    pair = join(box((0.1,) * 3, (0.6,) * 3), box((0.3,) * 3, (0.8,) * 3))
    check(pair, 4)
    hollow = join(box((0.1,) * 3, (0.9,) * 3), box((0.3,) * 3, (0.6,) * 3).flipped())
    check(hollow, 4)
    assert (voxelized(crumpled(1).flipped(), 4).dense() == 0).all()


def test_a_mesh_far_away_in_large_units():
    """Coordinates of a hundred thousand cells from the origin keep single-precision accuracy."""
    matrix, offset = 1e3 * np.eye(3), np.array([3e5, -2e5, 7e5])
    solid = crumpled(5)
    moved = solid.transformed(matrix, offset)
    found = voxelized(moved, 4, (offset, offset + 1e3)).dense()
    expected = np.clip(occupancies(solid, *UNIT, 16), 0, 1)
    assert np.abs(found - expected).max() < ROUNDING


def missing_bound(missing: Solid, depth: int) -> np.ndarray:
    """Bounds on the change of each cell of the unit cube when triangles are removed.

    A cell's octant has the cell's mean and a sum of seven coefficients. A piece of surface of
    vector area (ax, ay, az), in units of the cell's side s, changes it by

      sum over the axes i of ai Psi(pi) times 1 + u/2 + v/2 + uv/3,

    with u and v of 1 or -1 as the piece is in the octant's half along the other two axes or not.
    Psi is at most 1/2 and the rest at most 7/3: so 7/6 (|ax| + |ay| + |az|) for each cell that is
    split around the octant, up to the root, whose mean comes from moments that are at most the
    area along an axis.
    """
    n = 2**depth
    parts, cells = pieces(missing.corners, *UNIT, n)
    a, b, c = np.moveaxis(parts / n, 1, 0)
    areas = np.abs(0.5 * np.cross(b - a, c - a))
    total = np.zeros((n, n, n))
    x, y, z = np.clip(cells, 0, n - 1).T
    np.add.at(total, (x, y, z), areas.sum(axis=1))
    bound = np.full((1, 1, 1), areas.sum(axis=0).max())
    for level in range(depth):
        m = 2**level
        blocks = total.reshape(m, n // m, m, n // m, m, n // m).sum(axis=(1, 3, 5))
        # Octants have the bound of their cell and what this cell's own coefficients add.
        bound = np.kron(bound + 7 / 6 * blocks * m**2, np.ones((2, 2, 2)))
    return bound


@pytest.mark.parametrize("seed", range(3))
def test_a_hole_harms_what_is_around_it(seed, record_property):
    """1 % of a sphere's triangles are missing."""
    depth, center = 6, np.array([0.5, 0.49, 0.51])
    solid = sphere(0.4, 5, center)
    removed = np.random.default_rng(seed).choice(8192, 82, replace=False)
    missing = Solid(solid.positions, solid.triangles[removed])
    whole = voxelized(solid, depth).dense().astype(float)
    error = np.abs(voxelized(solid.without(removed), depth).dense() - whole)
    bound = missing_bound(missing, depth)
    # Values within 1e-5 of 0 and 1 are rounded where the surface does not pass.
    assert (error <= bound + 1e-5).all()

    middles = (np.stack(np.meshgrid(*[np.arange(64)] * 3, indexing="ij"), -1) + 0.5) / 64
    holes = missing.corners.mean(axis=1)
    distance = np.min([np.linalg.norm(middles - hole, axis=-1) for hole in holes], axis=0) * 64
    for near, far in ((0, 2), (2, 4), (4, 8), (8, 16), (16, 64)):
        there = (distance >= near) & (distance < far)
        line = f"error {error[there].max():.4f}, bound {bound[there].max():.4f}"
        record_property(f"{near} to {far} cells from a hole", line)
        print(f"{near} to {far} cells from a hole: {line}")
    # So inside and outside are distinguished everywhere except at the holes themselves.
    assert error[distance > 4].max() < 0.25


def test_a_hole_leaves_cells_alone_that_share_no_parent_with_it():
    """The missing triangles are in one octant: only the root's coefficients reach the others."""
    depth, solid = 5, sphere(0.4, 4, (0.5, 0.5, 0.5))
    middles = solid.corners.mean(axis=1)
    removed = np.flatnonzero((middles > 0.6).all(axis=1))[:10]
    closed, holed = voxelized(solid, depth), voxelized(solid.without(removed), depth)
    difference = holed.dense().astype(float) - closed.dense()
    for octant in range(7):
        x, y, z = (slice(16 * ((octant >> a) & 1), 16 * ((octant >> a) & 1) + 16) for a in range(3))
        surface = (closed.dense()[x, y, z] > 0.02) & (closed.dense()[x, y, z] < 0.98)
        shifts = difference[x, y, z][surface]
        assert np.ptp(shifts) < 1e-5


def test_the_volume_of_an_open_mesh_is_that_of_its_cells():
    solid = sphere(0.4, 3, (0.5, 0.5, 0.5)).without([3, 80, 81])
    octree = voxelized(solid, 5)
    assert octree.volume == pytest.approx(octree.dense().mean(dtype=float), abs=1e-7)
    assert octree.volume == pytest.approx(
        mesh_volume(*vars(sphere(0.4, 3, (0.5, 0.5, 0.5))).values()), rel=0.02
    )
