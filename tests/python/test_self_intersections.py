# SPDX-License-Identifier: GPL-3.0-or-later

"""Pairs of triangles that meet, against closed forms and the library's own exact tests in C++."""

import numpy as np
import prefilter
import pytest

BOX = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
FACES = np.array(
    [
        *((0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4)),
        *((2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)),
    ]
)


def two(offset):
    """Returns two boxes, the second moved."""
    return np.concatenate([BOX, BOX + offset]), np.concatenate([FACES, FACES + 8])


def test_a_box_does_not_meet_itself():
    assert prefilter.self_intersections(BOX, FACES).shape == (0, 2)


@pytest.mark.parametrize("threads", [1, 3])
def test_two_boxes_meet_where_they_overlap(threads):
    pairs = prefilter.self_intersections(*two((0.5, 0.25, 0.125)), threads=threads)
    assert len(pairs) > 0
    assert (pairs[:, 0] < 12).all()
    assert (pairs[:, 1] >= 12).all()
    assert (np.lexsort(pairs.T[::-1]) == np.arange(len(pairs))).all()


def test_boxes_apart_do_not_meet_and_boxes_that_touch_do():
    assert len(prefilter.self_intersections(*two((1.0001, 0, 0)))) == 0
    assert len(prefilter.self_intersections(*two((1, 0, 0)))) > 0


def test_two_triangles_that_cross():
    corners = np.array([(0, 0, 0), (2, 0, 0), (0, 2, 0), (0.5, 0.5, -1), (0.5, 0.5, 1), (9, 9, 0)])
    pairs = prefilter.self_intersections(corners, [(0, 1, 2), (3, 4, 5)])
    assert pairs.tolist() == [[0, 1]]


def test_a_triangle_without_area_makes_no_pair():
    corners = np.array([(0, 0, 0), (2, 0, 0), (1, 0, 0), (1, -1, -1), (1, 1, -1), (1, 0, 1)])
    assert len(prefilter.self_intersections(corners, [(0, 1, 2), (3, 4, 5)])) == 0


def test_bad_meshes_are_refused():
    with pytest.raises(ValueError, match="triangles"):
        prefilter.self_intersections(BOX, FACES + 4)
    with pytest.raises(ValueError, match="positions"):
        prefilter.self_intersections(BOX * np.nan, FACES)
    with pytest.raises(prefilter.Cancelled):
        prefilter.self_intersections(BOX, FACES, progress=lambda _: False)
