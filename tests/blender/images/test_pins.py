# SPDX-License-Identifier: GPL-3.0-or-later

"""Corners that are dragged, without a window."""

import numpy as np
import pytest
from prefilter.workflows.images import placement as placing

SIZE = (60, 40)
PLACES = np.array([(10.0, 5.0), (50.0, 8.0), (48.0, 35.0), (12.0, 30.0)])


@pytest.fixture
def pins(addon):
    return addon("images.pins")


@pytest.fixture
def canvas(pins):
    """Returns an image of which each pixel is 4 of the region, far from its corner."""
    return pins.Canvas((100.0, 50.0), (4.0, 4.0))


@pytest.fixture
def settings(addon):
    return addon("images.choices").ResampleSettings


def test_canvas(canvas):
    np.testing.assert_array_equal(canvas.to_region([(10, 5)]), [(140, 70)])
    np.testing.assert_array_equal(canvas.to_image([(140, 70)]), [(10, 5)])


def test_the_nearest_in_reach(pins, canvas):
    assert pins.nearest(PLACES, canvas, (301, 80), 14) == 1
    assert pins.nearest(PLACES, canvas, (320, 80), 14) is None


def test_a_corner_follows_the_mouse(pins, canvas):
    # Pressed beside the corner, which does not jump there.
    drag = pins.Drag(PLACES[0], (143, 72))
    np.testing.assert_allclose(drag.to((147, 70), canvas, SIZE), (11, 4.5))
    np.testing.assert_allclose(drag.to((187, 70), canvas, SIZE, is_slow=True), (12, 4.5))
    np.testing.assert_allclose(drag.to((188, 71), canvas, SIZE, snaps=True), (12, 5))
    # The part removed by snapping is not lost.
    np.testing.assert_allclose(drag.to((188, 71), canvas, SIZE), (12.25, 4.75))


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ((20.4, 30.6), (20, 31)),
        ((1.6, -1.4), (0, 0)),
        ((58.2, 41.7), (60, 40)),
        ((57, 43), (57, 43)),
    ],
)
def test_snapping(pins, canvas, place, expected):
    np.testing.assert_array_equal(pins.snapped(place, canvas, SIZE), expected)


def test_corners_begin_in_sight(pins, settings):
    changed = pins.initial_changes(settings())
    assert changed["warp"] == "rectify"
    assert changed["lower_left"] == pytest.approx((0.2, 0.2))
    assert changed["upper_left"] == pytest.approx((0.2, 0.8))
    assert pins.initial_changes(settings(warp="corners")) == {}
    assert pins.initial_changes(settings(warp="rectify", lower_left=(0.1, 0.0))) == {}


@pytest.mark.parametrize(
    ("options", "frame"),
    [
        ({"warp": "rectify", "size": "pixels"}, SIZE),
        ({"warp": "corners"}, SIZE),
        ({"warp": "corners", "size": "pixels", "width": 200, "height": 100}, (200, 100)),
    ],
)
def test_settings_store_relative_positions(addon, pins, settings, options, frame):
    shares = pins.shares((15, 10), settings(**options), SIZE)
    assert shares == pytest.approx((15 / frame[0], 10 / frame[1]))
    placed = settings(**options, lower_left=shares)
    corners = placing.corners(placed, *SIZE)
    np.testing.assert_allclose(corners[0], (15, 10))


def test_the_grid_is_straight(addon, pins):
    """Its lines end on the sides, and the middle ones cross where the diagonals do."""
    lines = pins.grid(PLACES)
    assert lines.shape == (2 * (pins.GRID - 1), 2, 2)
    middle = pins.GRID // 2 - 1

    def crossing(a, b, c, d):
        solved = np.linalg.solve(np.stack([b - a, c - d], axis=1), c - a)
        return a + solved[0] * (b - a)

    expected = crossing(PLACES[0], PLACES[2], PLACES[1], PLACES[3])
    np.testing.assert_allclose(crossing(*lines[middle], *lines[pins.GRID - 1 + middle]), expected)
    with pytest.raises(ValueError, match="convex"):
        pins.grid(PLACES[[0, 2, 1, 3]])


def test_uv_of_box_maps_the_corners(addon, pins):
    placement = placing
    matrix = pins.uv_of_box(placement.moved(5.0, 0.0), (10, 20), (30, 10), SIZE)
    ends = placement.applied(matrix, [(0, 0), (1, 1)])
    np.testing.assert_allclose(ends, [(15 / 60, 20 / 40), (45 / 60, 30 / 40)])
