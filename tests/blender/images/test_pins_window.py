# SPDX-License-Identifier: GPL-3.0-or-later

"""Corners dragged with the mouse and by keys, in a window that nobody sees."""

from pathlib import Path

import numpy as np
import pytest

SESSION = Path(__file__).with_name("pins_session.py")
FACADE = [(90, 60), (210, 60), (210, 140), (90, 140)]


def test_the_corners_begin_in_sight(found):
    assert found["warp"] == "rectify"
    assert found["button"]
    expected = [(60, 40), (240, 40), (240, 160), (60, 160)]
    np.testing.assert_allclose(found["corners at first"], expected, atol=1e-3)
    assert found["changed on screen"] > 0.01


def test_ctrl_snaps_to_whole_pixels(found):
    np.testing.assert_allclose(found["dragged"], FACADE, atol=1e-3)


def test_the_straightened_image_is_seen(found):
    assert found["straightened on screen"] > 0.5


def test_a_drag_is_undone_by_itself(found):
    assert found["before undo"] == pytest.approx([250, 180], abs=1.0)
    np.testing.assert_allclose(found["undone"], FACADE, atol=1e-3)
    assert found["runs after undo"]


def test_keys(found):
    expected = [(90, 60), (210, 60), (211, 150), (90, 139.9)]
    np.testing.assert_allclose(found["nudged"], expected, atol=1e-3)


def test_a_drag_is_reverted(found):
    assert found["while dragging"] != found["drag taken back"]
    assert found["drag taken back"] == pytest.approx([90, 60], abs=1e-3)
    assert found["runs after that"]


def test_esc_reverts_all_corners(found):
    warp, *corners = found["after Esc"]
    assert warp == "affine"
    np.testing.assert_allclose(corners, [(0, 0), (300, 0), (300, 200), (0, 200)])


def test_enter_keeps(found):
    assert found["after Enter"] == pytest.approx([200, 50], abs=1.0)


def test_another_press_ends_it(found):
    assert found["ends by a second press"]


def test_corners_are_those_of_the_source(found):
    assert found["ends where the result is shown"]
    assert found["dragged on"] == "Facade"
