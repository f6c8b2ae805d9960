# SPDX-License-Identifier: GPL-3.0-or-later

"""Any mesh as a solid, against volumes and winding numbers by other methods."""

import numpy as np
import prefilter
import pytest
from solids import (
    Solid,
    box,
    crumpled,
    join,
    mesh_volume,
    random_rotation,
    sheet,
    shuffled,
    soup,
    sphere,
    torus,
)

from bench.voxels.measures import topology

CELL = 2 / 128


def level(x, y):
    return 0 * x


def volume(found):
    return mesh_volume(found.positions, found.triangles)


CLOSED = {
    "sphere": sphere(),
    "torus": torus(0.8, 0.3, 60, 30),
    "crumpled": crumpled(3),
    "apart": join(sphere(0.5), box((2, 2, 2), (3, 3, 3))),
    "crossing": join(sphere(), box((0, 0, 0), (2, 2, 2))),
    "nested": join(sphere(), sphere(0.4)),
    "hollow": join(sphere(), sphere(0.6).flipped()),
    "in a hollow": join(sphere(), sphere(0.6).flipped(), sphere(0.3)),
}


@pytest.mark.parametrize("name", CLOSED)
def test_what_is_closed_and_oriented_is_unchanged(name):
    solid = CLOSED[name]
    found = prefilter.as_solid(solid.positions, solid.triangles, cell=CELL)
    assert found.is_unchanged
    assert np.array_equal(found.positions, solid.positions)
    assert np.array_equal(found.triangles, solid.triangles)
    assert found.turned_faces == found.turned_parts == found.welded_vertices == 0


@pytest.mark.parametrize("name", ["sphere", "torus", "crumpled", "apart", "crossing"])
@pytest.mark.parametrize("change", ["flipped", "shuffled", "soup"])
def test_faces_are_turned_the_right_way(name, change):
    solid = CLOSED[name]
    positions = solid.positions
    triangles = solid.triangles
    if change == "flipped":
        triangles = triangles[:, ::-1]
    elif change == "shuffled":
        triangles = shuffled(solid.triangles)
    else:
        positions, triangles = vars(soup(solid)).values()
    found = prefilter.as_solid(positions, triangles, cell=CELL)
    assert volume(found) == pytest.approx(solid.volume, rel=1e-12)


def test_a_hollow_inside_out_stays_hollow():
    solid = join(sphere(), sphere(0.6).flipped()).flipped()
    found = prefilter.as_solid(solid.positions, solid.triangles, cell=CELL)
    assert found.turned_parts == 2
    assert volume(found) == pytest.approx(-solid.volume)


def test_shells_in_shells_are_cavities_where_faces_say_nothing():
    shells = join(sphere(), sphere(0.8), sphere(0.6))
    found = prefilter.as_solid(shells.positions, shuffled(shells.triangles), cell=CELL)
    expected = sphere().volume - sphere(0.8).volume + sphere(0.6).volume
    assert volume(found) == pytest.approx(expected)


def test_finer_borders_are_sewn_to_coarser_ones():
    """Two halves of a cube, with another number of vertices along their border."""
    low, high = box((-1, -1, -1), (1, 1, 0)), box((-1, -1, 0), (1, 1, 1))
    coarse = Solid(low.positions, low.triangles[:10])  # without its top
    fine = Solid(high.positions, np.delete(high.triangles, [8, 9], axis=0))
    # Each side of the upper half is a fan over its lower edge, cut in five.
    sides, points = list(fine.triangles[8:]), list(fine.positions)
    for a, b in ((0, 1), (1, 3), (3, 2), (2, 0)):
        cuts = [a]
        for k in range(1, 5):
            points.append(points[a] + (points[b] - points[a]) * (k / 5))
            cuts.append(len(points) - 1)
        cuts.append(b)
        sides += [(cuts[k], cuts[k + 1], a + 4) for k in range(5)]
        sides.append((b, b + 4, a + 4))
    both = join(coarse, Solid(np.array(points), np.array(sides)))
    found = prefilter.as_solid(both.positions, both.triangles, cell=CELL)
    assert found.parts == 1
    assert edge_balance(found.triangles) == 0
    assert volume(found) == pytest.approx(8.0)
    assert found.thickened_parts == found.filled_parts == 0


def test_one_part_inside_out_is_turned():
    solid = join(sphere(0.7), box((2, 2, 2), (3, 3, 3)).flipped())
    found = prefilter.as_solid(solid.positions, solid.triangles, cell=CELL)
    assert found.turned_parts == 1
    assert volume(found) == pytest.approx(sphere(0.7).volume + 1)


def test_faces_that_are_there_twice_count_once():
    solid = sphere()
    twice = np.concatenate([solid.triangles, solid.triangles[::2], solid.triangles[::5, ::-1]])
    found = prefilter.as_solid(solid.positions, twice, cell=CELL)
    assert found.duplicate_faces == len(twice) - len(solid.triangles)
    assert volume(found) == pytest.approx(solid.volume)
    copies = join(solid, solid)
    found = prefilter.as_solid(copies.positions, copies.triangles, cell=CELL)
    assert found.duplicate_faces == len(solid.triangles)
    assert volume(found) == pytest.approx(solid.volume)


def test_borders_are_welded_across_small_gaps():
    solid = sphere()
    positions, triangles = vars(soup(solid, jitter=0.01 * CELL)).values()
    found = prefilter.as_solid(positions, triangles, cell=CELL)
    assert found.welded_vertices == len(positions) - len(solid.positions)
    assert found.parts == 1
    assert volume(found) == pytest.approx(solid.volume, rel=1e-3)


def test_fine_details_are_not_welded():
    solid = sphere(0.01 * CELL)
    found = prefilter.as_solid(*vars(soup(solid)).values(), cell=CELL, thickness=0)
    assert volume(found) == pytest.approx(solid.volume)


@pytest.mark.parametrize("change", ["shuffled", "soup"])
def test_threads_change_nothing(change):
    solid = join(torus(0.8, 0.3, 120, 60), sphere(0.2))
    positions, triangles = solid.positions, shuffled(solid.triangles)
    if change == "soup":
        positions, triangles = vars(soup(solid, jitter=0.01 * CELL)).values()
    one, several = (
        prefilter.as_solid(positions, triangles, cell=CELL, threads=threads) for threads in (1, 5)
    )
    assert np.array_equal(one.positions, several.positions)
    assert np.array_equal(one.triangles, several.triangles)
    assert np.array_equal(one.origins, several.origins)


def contour_of(found, cell, depth=7):
    """The surface of the voxels of a solid, about the origin."""
    half = cell * 2**depth / 2
    closed = prefilter.close_holes(found.positions, found.triangles)
    octree = prefilter.voxelize(
        closed.positions, closed.triangles, depth=depth, bounds=([-half] * 3, [half] * 3)
    )
    return octree.contour(interpolant="plane")


def kept_share(solid, positions, triangles, distance):
    """The share of points of a solid's surface within `distance` of the given mesh."""
    random = np.random.default_rng(3)
    a, b, c = np.moveaxis(solid.corners, 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chosen = random.choice(len(areas), 2000, p=areas / areas.sum())
    weights = random.dirichlet((1, 1, 1), 2000)
    points = np.einsum("ij,ijk->ik", weights, solid.corners[chosen])
    _, _, distances = prefilter.nearest_points(points, positions, triangles)
    return np.mean(distances <= distance)


def edge_balance(triangles):
    """The number of edges that triangles traverse more often in one direction than the other."""
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    up = edges[:, 0] < edges[:, 1]
    unique, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    sums = np.bincount(which.reshape(-1), np.where(up, 1, -1), len(unique))
    return np.count_nonzero(sums)


SHEETS = {
    "plane": sheet(4, level),
    "hills": sheet(24, lambda x, y: 0.3 * np.sin(4 * x) * np.cos(5 * y)),
    "one triangle": Solid(np.eye(3), np.array([(0, 1, 2)])),
    "turned": sheet(4, level).transformed(random_rotation(4)),
}


@pytest.mark.parametrize("name", SHEETS)
def test_sheets_get_a_thickness(name):
    sheet = SHEETS[name]
    cell = 2.5 / 64
    found = prefilter.as_solid(sheet.positions, sheet.triangles, cell=cell, thickness=2.0)
    assert found.thickened_parts == 1
    assert edge_balance(found.triangles) == 0
    a, b, c = np.moveaxis(sheet.corners, 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    # The shell of a sheet has its area times the thickness, less or more where it is curved.
    assert volume(found) == pytest.approx(area * 2.0 * cell, rel=0.02)
    positions, triangles = contour_of(found, cell)
    assert kept_share(sheet, positions, triangles, 3 * cell) == 1.0


@pytest.mark.parametrize("height", [5, 8, 12])
def test_shallow_domes_are_sheets_as_a_whole(height):
    """Cells keep the volume behind a cap except its rim; closing holes makes no cap of 3 %."""
    dome = sheet(24, lambda x, y: height / 64 * (1 - (x * x + y * y) / 2))
    dome = dome.transformed(random_rotation(1))
    bounds = prefilter.cube_around(
        (dome.positions.min(axis=0), dome.positions.max(axis=0)), depth=7
    )
    cell = (bounds[1][0] - bounds[0][0]) / 128
    found = prefilter.as_solid(dome.positions, dome.triangles, cell=cell, sheets="faces")
    closed = prefilter.close_holes(found.positions, found.triangles)
    assert closed.left_open == 0
    mesh = closed.positions, closed.triangles
    tree = prefilter.voxelize(*mesh, depth=7, bounds=bounds, thickness=1.5)
    positions, triangles = tree.contour()
    assert topology(triangles) == (1, 0)
    assert kept_share(dome, positions, triangles, cell) == 1.0


def test_sheets_may_stay_sheets():
    plane = sheet(4, level)
    found = prefilter.as_solid(plane.positions, plane.triangles, cell=0.05, thickness=0)
    assert found.is_unchanged
    assert found.thickened_parts == 0


def test_thin_plates_get_a_thickness():
    plate = box((-1, -1, -0.001), (1, 1, 0.001)).transformed(random_rotation(1))
    cell = 3 / 64
    found = prefilter.as_solid(plate.positions, plate.triangles, cell=cell)
    assert found.thickened_parts == 1
    positions, triangles = contour_of(found, cell)
    assert kept_share(plate, positions, triangles, 2 * cell) == 1.0


def test_thick_parts_of_a_thin_mesh_stay_as_they_are():
    thick = box((-1, -1, -1), (1, 1, 0))
    both = join(thick, box((-1, -1, 0.5), (1, 1, 0.501)))
    found = prefilter.as_solid(both.positions, both.triangles, cell=3 / 64)
    assert found.thickened_parts == 1
    corners = found.positions[found.triangles]
    for corner in thick.corners:
        assert (corners == corner).all(axis=(1, 2)).any()


def test_leaky_parts_are_filled():
    solid = sphere(1.0, 3)
    middles = solid.corners.mean(axis=1, keepdims=True)
    corners = solid.corners + 0.05 * (middles - solid.corners)
    flipped = np.random.default_rng(5).random(len(corners)) < 0.5
    corners[flipped] = corners[flipped][:, ::-1]
    cell = 2 / 64
    triangles = np.arange(3 * len(corners)).reshape(-1, 3)
    found = prefilter.as_solid(corners.reshape(-1, 3), triangles, cell=cell, gap=2.0)
    assert found.filled_parts > 0.8 * len(corners)
    assert edge_balance(found.triangles) == 0
    assert volume(found) == pytest.approx(solid.volume, rel=0.03)
    open_ = prefilter.as_solid(corners.reshape(-1, 3), triangles, cell=cell, gap=0)
    assert open_.filled_parts == 0


def test_open_parts_have_their_outside_outside():
    """A box without a bottom, each way around."""
    solid = box((-1, -1, -1), (1, 1, 1)).transformed(random_rotation(2))
    lidless = Solid(solid.positions, solid.triangles[:10])
    for triangles in (lidless.triangles, lidless.triangles[:, ::-1], shuffled(lidless.triangles)):
        found = prefilter.as_solid(lidless.positions, triangles, cell=4 / 64)
        closed = prefilter.close_holes(found.positions, found.triangles)
        a, b, c = np.moveaxis(closed.positions[closed.triangles], 1, 0)
        enclosed = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
        assert enclosed == pytest.approx(8.0)


def test_walls_inside_are_dropped():
    left = box((-1, -0.5, -0.5), (0, 0.5, 0.5))
    right = Solid(box((0, -0.5, -0.5), (1, 0.5, 0.5)).positions, left.triangles[2:])
    both = join(left, right).transformed(random_rotation(6))
    found = prefilter.as_solid(both.positions, shuffled(both.triangles), cell=2.2 / 64)
    assert volume(found) == pytest.approx(2.0)
    assert len(found.triangles) == 20
    assert found.thickened_parts == 0


def test_origins_name_the_triangles_that_others_come_from():
    both = join(sphere(0.5), sheet(4, level).transformed(np.eye(3), (0, 0, 2)))
    found = prefilter.as_solid(both.positions, both.triangles, cell=0.05)
    assert found.thickened_parts == 1
    assert set(found.origins) == set(range(len(both.triangles)))
    kept = found.origins < len(sphere().triangles)
    assert np.array_equal(found.positions[found.triangles[kept]], both.corners[found.origins[kept]])


def test_nothing_with_an_area_is_no_solid():
    flat = Solid(np.zeros((3, 3)), np.array([(0, 1, 2)]))
    found = prefilter.as_solid(flat.positions, flat.triangles, cell=0.1)
    assert found.is_unchanged
    assert found.parts == 0


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_units_do_not_matter(scale):
    plane, ball = sheet(4, level), sphere()
    small = prefilter.as_solid(plane.positions * scale, plane.triangles, cell=0.05 * scale)
    usual = prefilter.as_solid(plane.positions, plane.triangles, cell=0.05)
    assert np.allclose(small.positions / scale, usual.positions)
    assert np.array_equal(small.triangles, usual.triangles)
    found = prefilter.as_solid(ball.positions * scale, shuffled(ball.triangles), cell=0.05 * scale)
    assert (
        found.turned_faces
        == prefilter.as_solid(ball.positions, shuffled(ball.triangles), cell=0.05).turned_faces
    )


def test_threads_change_nothing_about_sheets_and_leaks():
    leaky = sphere(1.0, 3)
    middles = leaky.corners.mean(axis=1, keepdims=True)
    corners = leaky.corners + 0.05 * (middles - leaky.corners)
    lifted = sheet(16, lambda x, y: 2 + 0.2 * np.sin(3 * x))
    both = join(Solid(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)), lifted)
    one, several = (
        prefilter.as_solid(both.positions, both.triangles, cell=0.04, threads=threads)
        for threads in (1, 5)
    )
    assert one.thickened_parts > 0
    assert one.filled_parts > 0
    assert np.array_equal(one.positions, several.positions)
    assert np.array_equal(one.triangles, several.triangles)


def test_turned_faces_are_named():
    ball = sphere(1.0, 3)
    rng = np.random.default_rng(2)
    chosen = np.sort(rng.choice(len(ball.triangles), 40, replace=False))
    triangles = ball.triangles.copy()
    triangles[chosen] = triangles[chosen][:, ::-1]
    found = prefilter.as_solid(ball.positions, triangles, cell=0.05)
    assert found.turned.tolist() == chosen.tolist()
    found = prefilter.as_solid(ball.positions, ball.triangles[:, ::-1], cell=0.05)
    assert found.turned.tolist() == list(range(len(ball.triangles)))
    assert len(prefilter.as_solid(ball.positions, ball.triangles, cell=0.05).turned) == 0


def without_back(solid, depth):
    """The solid without the triangles that reach below z = depth."""
    corners = solid.positions[solid.triangles]
    return Solid(solid.positions, solid.triangles[corners[..., 2].min(axis=1) >= depth])


@pytest.mark.parametrize("sheets", ["faces", "shell"])
@pytest.mark.parametrize("middle", [-0.15, -0.05, 0.0])
def test_what_reaches_into_another_part_is_no_sheet(middle, sheets):
    """An eye in its socket is open at the back, where the head covers it: nothing is lost."""
    head = box((-1, -1, -1), (1, 1, 0))
    eye = without_back(sphere(0.5), -0.4)
    moved = Solid(eye.positions + np.array([0, 0, middle]), eye.triangles)
    mesh = join(head, moved)
    found = prefilter.as_solid(mesh.positions, mesh.triangles, cell=CELL, sheets=sheets)
    assert found.thickened_parts == 0
    assert len(found.triangles) == len(mesh.triangles)
    closed = prefilter.close_holes(found.positions, found.triangles)
    tree = prefilter.voxelize(closed.positions, closed.triangles, depth=7, thickness=1.5)
    # The volume above the head: a ball's cap (Archimedes).
    height = 0.5 + middle
    cap = np.pi * height**2 * (0.5 - height / 3)
    assert tree.volume == pytest.approx(4.0 + cap, rel=5e-3)
