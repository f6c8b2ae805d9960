"""Any mesh as a solid, against volumes and winding numbers by other methods."""

import numpy as np
import prefilter
import pytest
from solids import box, crumpled, join, sphere, torus

CELL = 2 / 128


def soup(solid, jitter=0.0):
    """Triangles that share no vertices, each corner moved by up to `jitter` along each axis."""
    corners = solid.corners.reshape(-1, 3)
    moved = corners + np.random.default_rng(1).uniform(-jitter, jitter, corners.shape)
    return moved, np.arange(len(corners)).reshape(-1, 3)


def shuffled(solid):
    """Half of the faces turned."""
    triangles = solid.triangles.copy()
    turned = np.random.default_rng(2).random(len(triangles)) < 0.5
    triangles[turned] = triangles[turned][:, ::-1]
    return triangles


def volume(found):
    a, b, c = np.moveaxis(found.positions[found.triangles], 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


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
        triangles = shuffled(solid)
    else:
        positions, triangles = soup(solid)
    found = prefilter.as_solid(positions, triangles, cell=CELL)
    assert volume(found) == pytest.approx(solid.volume, rel=1e-12)


def test_a_hollow_inside_out_stays_hollow():
    solid = join(sphere(), sphere(0.6).flipped()).flipped()
    found = prefilter.as_solid(solid.positions, solid.triangles, cell=CELL)
    assert found.turned_parts == 2
    assert volume(found) == pytest.approx(-solid.volume)


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
    positions, triangles = soup(solid, 0.01 * CELL)
    found = prefilter.as_solid(positions, triangles, cell=CELL)
    assert found.welded_vertices == len(positions) - len(solid.positions)
    assert found.parts == 1
    assert volume(found) == pytest.approx(solid.volume, rel=1e-3)


def test_fine_details_are_not_welded():
    solid = sphere(0.01 * CELL)
    found = prefilter.as_solid(*soup(solid), cell=CELL, thickness=0)
    assert volume(found) == pytest.approx(solid.volume)


@pytest.mark.parametrize("change", ["shuffled", "soup"])
def test_threads_change_nothing(change):
    solid = join(torus(0.8, 0.3, 120, 60), sphere(0.2))
    positions, triangles = solid.positions, shuffled(solid)
    if change == "soup":
        positions, triangles = soup(solid, 0.01 * CELL)
    one, several = (
        prefilter.as_solid(positions, triangles, cell=CELL, threads=threads) for threads in (1, 5)
    )
    assert np.array_equal(one.positions, several.positions)
    assert np.array_equal(one.triangles, several.triangles)
    assert np.array_equal(one.origins, several.origins)
