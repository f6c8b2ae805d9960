# SPDX-License-Identifier: GPL-3.0-or-later

"""Contours of quads: closed, two-manifold, on their sources, with their edges and corners."""

import numpy as np
import prefilter
import pytest
from solids import box, random_rotation, sphere


def cube(seed, scale=1.0, middle=(0.0, 0.0, 0.0)):
    made = box((-0.5,) * 3, (0.5,) * 3).transformed(scale * random_rotation(seed), middle)
    return made.positions, made.triangles


def halves(quads):
    return quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)


def normals(positions, triangles):
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    crossed = np.cross(b - a, c - a)
    areas = np.linalg.norm(crossed, axis=1)
    return crossed / areas[:, None], areas / 2


def volume(positions, quads):
    a, b, c = (positions[halves(quads)[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def sides(quads):
    """Each side in its quad's direction, and the index of its undirected edge."""
    directed = np.concatenate([quads[:, [k, (k + 1) % 4]] for k in range(4)])
    _, edges = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    return directed, edges.reshape(-1)


def assert_closed(positions, quads):
    """Asserts that edges occur once in each direction, and that each vertex has one fan."""
    directed, edges = sides(quads)
    assert (np.bincount(edges) == 2).all()
    assert len(np.unique(directed, axis=0)) == len(directed)
    assert len(np.unique(quads)) == len(positions)
    after = {}
    for row in quads.tolist():
        for k in range(4):
            after[row[k], row[(k + 1) % 4]] = row[k - 1]
    around = np.bincount(quads.ravel())
    for row in quads.tolist():
        for k in range(4):
            at, steps = after[row[k], row[(k + 1) % 4]], 1
            while at != row[(k + 1) % 4]:
                at, steps = after[row[k], at], steps + 1
            assert steps == around[row[k]]


def euler(positions, quads):
    return len(positions) - 2 * len(quads) + len(quads)


def most_turn(positions, quads, sides=None):
    """The largest angle between triangles at an edge, in degrees, when quads are halved.

    `sides` has the true normal under each triangle; their own angle beyond 90 degrees is
    subtracted.
    """
    triangles = halves(quads)
    found, _ = normals(positions, triangles)
    ends = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    order = np.lexsort(np.sort(ends, axis=1).T)
    pairs = np.tile(np.arange(len(triangles)), 3)[order].reshape(-1, 2)
    turns = np.degrees(np.arccos(np.einsum("ij,ij->i", *found[pairs.T]).clip(-1, 1)))
    if sides is not None:
        true = np.degrees(np.arccos(np.einsum("ij,ij->i", *sides[pairs.T]).clip(-1, 1)))
        turns -= np.maximum(true - 90.0, 0.0)
    return turns.max()


def tree_of(mesh, bounds=None, depth=6):
    return prefilter.voxelize(*mesh, depth=depth, bounds=bounds)


def cell_of(tree):
    low, high = np.array(tree.bounds)
    return (high - low)[0] / 2**tree.depth


@pytest.mark.parametrize("seed", range(6))
def test_turned_cubes_have_their_faces_edges_and_corners(seed):
    mesh = cube(seed)
    tree = tree_of(mesh)
    found = tree.quad_contour(sources=[mesh])
    assert_closed(found.positions, found.quads)
    assert euler(found.positions, found.quads) == 2
    assert volume(found.positions, found.quads) == pytest.approx(1.0, abs=1e-6)
    local = np.abs(found.positions @ random_rotation(seed))
    # On a face, an edge or a corner, to a hundredth of a cell.
    assert np.abs(local.max(axis=1) - 0.5).max() < 0.01 * cell_of(tree)
    corners = (np.abs(local - 0.5) < 0.01 * cell_of(tree)).all(axis=1)
    assert corners.sum() == 8
    # Edges of the cube are edges of the mesh, from end to end.
    directed, _ = sides(found.quads)
    ends = found.positions[directed]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    places = np.concatenate([ends, ends.mean(axis=1, keepdims=True)], axis=1)
    off = np.abs(np.abs(places @ random_rotation(seed)) - 0.5)
    lengths = lengths[((off < 1e-9).sum(axis=2) >= 2).all(axis=1)]
    assert lengths.sum() / 2 == pytest.approx(12.0, rel=1e-6)
    assert most_turn(found.positions, found.quads) < 91.0


@pytest.mark.parametrize("height", [8.0, 5.0, 16 / 3])
@pytest.mark.parametrize("depth", [4, 5, 6])
def test_upright_boxes_have_their_corners(height, depth):
    """At height 8 upright sides run through cell centers, so many positions are ambiguous."""
    made = box((-1, -1, 0), (1, 1, height))
    mesh = made.positions, made.triangles
    tree = tree_of(mesh, depth=depth)
    found = tree.quad_contour(sources=[mesh])
    assert_closed(found.positions, found.quads)
    assert volume(found.positions, found.quads) == pytest.approx(4 * height, rel=2e-5)
    off = np.abs(found.positions - (0, 0, height / 2)) - (1, 1, height / 2)
    assert np.abs(off.max(axis=1)).max() < 0.01 * cell_of(tree)
    for corner in made.positions:
        off = np.linalg.norm(found.positions - corner, axis=1).min()
        assert off < 0.001 * cell_of(tree)


def test_quads_come_from_the_faces_that_they_lie_on():
    mesh = cube(3)
    found = tree_of(mesh).quad_contour(sources=[mesh])
    facing, areas = normals(found.positions, halves(found.quads))
    of_source, _ = normals(*mesh)
    agreement = np.einsum("ij,ij->i", facing, np.repeat(of_source[found.origins], 2, axis=0))
    assert areas[agreement < 0.999].sum() < 1e-9


@pytest.mark.parametrize("interpolant", ["plane", "sharp"])
def test_vertices_are_on_spheres(interpolant):
    """The means of loops alone are up to 0.06 of a cell inside, and 0.02 in the mean."""
    ball = sphere(10.0, 6)
    tree = prefilter.voxelize(
        ball.positions, ball.triangles, depth=5, bounds=((-16,) * 3, (16,) * 3)
    )
    found = tree.quad_contour(interpolant=interpolant)
    assert found.origins is None
    assert_closed(found.positions, found.quads)
    assert euler(found.positions, found.quads) == 2
    distances = np.linalg.norm(found.positions, axis=1) - 10.0
    assert np.abs(distances).max() < 0.035
    assert np.abs(distances.mean()) < 0.006
    assert most_turn(found.positions, found.quads) < 20.0


def beside(quads, count):
    """The mean of the vertices beside each one, as a matrix would give it."""
    ends = np.unique(np.sort(sides(quads)[0], axis=1), axis=0)
    ends = np.concatenate([ends, ends[:, ::-1]])

    def mean(positions):
        sums = np.zeros((count, 3))
        np.add.at(sums, ends[:, 0], positions[ends[:, 1]])
        return sums / np.bincount(ends[:, 0], minlength=count)[:, None]

    return mean


def test_quads_are_regular_where_there_are_no_edges():
    """No vertex is far from the mean of its neighbors, and sides have similar lengths.

    Sides from Blender's Voxel Remesh differ by 0.22 of their mean, the shortest by more than half.
    """
    ball = sphere(10.0, 6)
    tree = prefilter.voxelize(
        ball.positions, ball.triangles, depth=5, bounds=((-16,) * 3, (16,) * 3)
    )
    found = tree.quad_contour()
    ends = found.positions[sides(found.quads)[0]]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    assert lengths.std() < 0.17 * lengths.mean()
    assert lengths.min() > 0.6 * lengths.mean()
    assert lengths.max() < 1.4 * lengths.mean()
    up = found.positions / np.linalg.norm(found.positions, axis=1, keepdims=True)
    off = beside(found.quads, len(found.positions))(found.positions) - found.positions
    off -= np.einsum("ij,ij->i", off, up)[:, None] * up
    assert np.linalg.norm(off, axis=1).mean() < 0.03
    corners = found.positions[found.quads]
    after = np.roll(corners, -1, axis=1) - corners
    before = np.roll(corners, 1, axis=1) - corners
    cosines = np.einsum("ijk,ijk->ij", after, before)
    cosines /= np.linalg.norm(after, axis=2) * np.linalg.norm(before, axis=2)
    assert np.abs(cosines).max() < np.cos(np.radians(30))


@pytest.mark.parametrize("operation", ["union", "intersection", "difference"])
def test_rims_lie_on_both_operands(operation):
    first, second = cube(5), cube(57, 0.8, (0.45, 0.35, 0.3))
    corners = np.concatenate([first[0], second[0]])
    bounds = prefilter.cube_around((corners.min(0), corners.max(0)), depth=7)
    tree = getattr(tree_of(first, bounds, 7), operation)(tree_of(second, bounds, 7))
    found = tree.quad_contour(sources=[first, second])
    assert_closed(found.positions, found.quads)
    assert volume(found.positions, found.quads) == pytest.approx(tree.volume, rel=1e-3)
    facing, areas = normals(found.positions, halves(found.quads))
    inner = -1.0 if operation == "difference" else 1.0
    of_sources = np.concatenate([normals(*first)[0], inner * normals(*second)[0]])
    along = np.repeat(of_sources[found.origins], 2, axis=0)
    agreement = np.einsum("ij,ij->i", facing, along)
    assert areas[agreement < np.cos(np.radians(1))].sum() < 0.01 * areas.sum()
    assert most_turn(found.positions, found.quads, along) < 120.0


def test_groups_part_quads():
    mesh = cube(0)
    groups = (mesh[0][mesh[1]].mean(axis=1) @ random_rotation(0)[:, 0] > 0.0).astype(np.int32)
    found = tree_of(mesh).quad_contour(sources=[(*mesh, groups)])
    of_quads = groups[found.origins]
    assert set(of_quads) == {0, 1}
    assert_closed(found.positions, found.quads)


def test_solids_of_whole_cells_have_quads_of_one_size():
    """Large leaves that are full lie beside large empty ones."""
    solid = box((-4,) * 3, (4,) * 3)
    tree = prefilter.voxelize(
        solid.positions, solid.triangles, depth=4, bounds=((-8,) * 3, (8,) * 3)
    )
    found = tree.quad_contour(interpolant="plane")
    assert_closed(found.positions, found.quads)
    assert len(found.quads) == 6 * 8**2
    sharp = tree.quad_contour(sources=[(solid.positions, solid.triangles)])
    assert volume(sharp.positions, sharp.quads) == pytest.approx(512.0)


@pytest.mark.parametrize("interpolant", ["occupancy", "plane", "linear", "sharp"])
def test_quads_do_not_depend_on_threads(interpolant):
    first, second = cube(5), cube(57, 0.8, (0.45, 0.35, 0.3))
    bounds = ((-1.2,) * 3, (1.2,) * 3)
    tree = tree_of(first, bounds).difference(tree_of(second, bounds))
    sources = [first, second] if interpolant == "sharp" else None
    one, other = (
        tree.quad_contour(interpolant=interpolant, sources=sources, threads=threads)
        for threads in (1, 3)
    )
    assert np.array_equal(one.positions, other.positions)
    assert np.array_equal(one.quads, other.quads)
    assert sources is None or np.array_equal(one.origins, other.origins)


def test_nothing_is_no_quads():
    mesh = cube(0, 0.01)
    tree = prefilter.voxelize(*mesh, depth=2, bounds=((-1,) * 3, (1,) * 3))
    found = tree.quad_contour()
    assert found.quads.shape == (0, 4)
    assert found.positions.shape == (0, 3)
