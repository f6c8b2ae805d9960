# SPDX-License-Identifier: GPL-3.0-or-later

"""The line of a wipe dragged with the mouse, in a window that nobody sees."""

from pathlib import Path

import pytest

SESSION = Path(__file__).with_name("wipe_session.py")


@pytest.fixture(params=["levels", "plane"])
def here(found, request):
    """Returns by how many pixels a line has moved, of each of the views."""
    return found[request.param]


def test_line_follows_the_mouse(here):
    assert here["dragged"] == pytest.approx(60, abs=1.5)
    assert here["near"] == pytest.approx(-40, abs=1.5)
    assert here["slowly"] == pytest.approx(5, abs=1.5)


def test_line_and_cursor_change_under_the_mouse(here):
    assert here["shows that it can be taken"]


def test_ctrl_snaps(here):
    assert here["share snapped"] == 0.625


def test_dragging_beside_the_line_moves_nothing(here):
    assert here["beside"] == 0


def test_esc_restores_the_position(here):
    assert here["taken back"] == pytest.approx(0, abs=1e-3)


def test_line_stays_inside_the_editor(here):
    assert here["share at the edge"] == 0


def test_without_a_line_nothing_is_dragged(found):
    assert found["levels"]["without a line"] == 0
