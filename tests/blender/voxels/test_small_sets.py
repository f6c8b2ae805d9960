# SPDX-License-Identifier: GPL-3.0-or-later

"""Small face sets on a surface: the covered faces are known from positions."""

import numpy as np
import pytest


def grid(count, size, sides, numbers=None):
    """Returns positions and faces of a square of count x count squares, each cut or whole."""
    x, y = np.meshgrid(np.linspace(0, size, count + 1), np.linspace(0, size, count + 1))
    positions = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    i, j = np.indices((count, count)).reshape(2, -1)
    a = i * (count + 1) + j
    quads = np.stack([a, a + 1, a + count + 2, a + count + 1], axis=1).astype(np.int32)
    if sides == 3:
        quads = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    return positions, quads


def middles(positions, faces):
    return positions[faces].mean(axis=1)


@pytest.fixture
def small_sets(addon):
    return addon("voxels.small_sets")


@pytest.mark.parametrize("sides", [3, 4])
def test_a_set_between_centers_gets_the_face_that_it_covers(small_sets, sides):
    positions, faces = grid(40, 10.0, 3)
    at = middles(positions, faces)
    # Half a cell around a corner of four cells, 0.2 off of it.
    numbers = np.where(np.abs(at[:, :2] - [5.2, 5.2]).max(axis=1) < 0.5, 9, 4)
    coarse = grid(10, 10.0, sides)
    surface = small_sets.NumberedFaces(*coarse, np.full(len(coarse[1]), 4))
    source = small_sets.NumberedFaces(positions, faces, numbers)
    found = small_sets.with_small_sets(source, surface, 1.0, 1)
    assert (surface.numbers == 4).all()
    has = found == 9
    where = middles(*coarse)[has]
    assert has.sum() == (2 if sides == 3 else 1)
    assert (np.abs(where[:, :2] - 5.5).max(axis=1) < 0.5).all()
    assert set(found[~has]) == {4}


def test_a_strip_keeps_its_area(small_sets):
    positions, faces = grid(80, 10.0, 3)
    at = middles(positions, faces)
    numbers = np.where((np.abs(at[:, 0] - 5.0) < 0.25) & (np.abs(at[:, 1] - 5.0) < 4.0), 9, 4)
    coarse = grid(10, 10.0, 4)
    surface = small_sets.NumberedFaces(*coarse, np.full(100, 4))
    source = small_sets.NumberedFaces(positions, faces, numbers)
    found = small_sets.with_small_sets(source, surface, 1.0, 1)
    assert (found == 9).sum() == 4
    assert np.abs(middles(*coarse)[found == 9][:, 0] - 5.0).max() < 0.6


def test_removed_and_tiny_sets_are_not_restored(small_sets):
    positions, faces = grid(40, 10.0, 3)
    at = middles(positions, faces)
    numbers = np.full(len(faces), 4)
    numbers[np.abs(at[:, :2] - 5.0).max(axis=1) < 0.2] = 7  # A sixth of a face.
    numbers[at[:, 0] < 5.0] += 100
    coarse = grid(10, 10.0, 4)
    surface = small_sets.NumberedFaces(*coarse, np.full(100, 4))
    away = small_sets.NumberedFaces(np.add(positions, (0, 0, 3.0)), faces, numbers)
    for source in (small_sets.NumberedFaces(positions, faces, numbers), away):
        assert set(small_sets.with_small_sets(source, surface, 1.0, 1)) == {4}


def test_no_set_loses_its_last_face(small_sets):
    positions, faces = grid(40, 10.0, 3)
    at = middles(positions, faces)[:, :2]
    numbers = np.full(len(faces), 4)
    numbers[(at > 5.0).all(axis=1) & (at < 6.0).all(axis=1)] = 9
    coarse = grid(10, 10.0, 4)
    owned = np.full(100, 4)
    (center,) = np.flatnonzero(np.abs(middles(*coarse)[:, :2] - 5.5).max(axis=1) < 0.1)
    owned[center] = 5
    surface = small_sets.NumberedFaces(*coarse, owned)
    source = small_sets.NumberedFaces(positions, faces, numbers)
    assert set(small_sets.with_small_sets(source, surface, 1.0, 1)) == {4, 5}


def test_two_sets_in_one_face(small_sets):
    """The one that covers more of it gets the face."""
    positions, faces = grid(80, 10.0, 3)
    at = middles(positions, faces)[:, :2]
    inside = (at > 5.0).all(axis=1) & (at < 6.0).all(axis=1)
    numbers = np.full(len(faces), 4)
    numbers[inside] = np.where(at[inside, 0] < 5.45, 8, 9)
    coarse = grid(10, 10.0, 4)
    surface = small_sets.NumberedFaces(*coarse, np.full(100, 4))
    source = small_sets.NumberedFaces(positions, faces, numbers)
    found = small_sets.with_small_sets(source, surface, 1.0, 1)
    assert (found == 9).sum() == 1
    assert (found == 8).sum() == 0


def test_booleans(small_sets):
    positions, faces = grid(40, 10.0, 3)
    numbers = np.abs(middles(positions, faces)[:, :2] - 5.2).max(axis=1) < 0.5
    coarse = grid(10, 10.0, 4)
    surface = small_sets.NumberedFaces(*coarse, np.zeros(100, bool))
    source = small_sets.NumberedFaces(positions, faces, numbers)
    found = small_sets.with_small_sets(source, surface, 1.0, 1)
    assert found.dtype == bool
    assert found.sum() == 1
