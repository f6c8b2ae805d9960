# SPDX-License-Identifier: GPL-3.0-or-later

"""The line of a wipe dragged with the mouse, in a window that nobody sees."""

from pathlib import Path

import pytest

SESSION = Path(__file__).with_name("wipe_session.py")


@pytest.fixture(params=["levels", "plane"])
def here(found, request):
    """Returns by how many pixels a line has moved, of each of the views."""
    return found[request.param]


def test_it_follows_the_mouse(here):
    assert here["dragged"] == pytest.approx(60, abs=1.5)
    assert here["near"] == pytest.approx(-40, abs=1.5)
    assert here["slowly"] == pytest.approx(5, abs=1.5)


def test_it_and_the_pointer_show_that_it_can_be_taken(here):
    assert here["shows that it can be taken"]


def test_ctrl_snaps(here):
    assert here["share snapped"] == 0.625


def test_beside_it_nothing_moves(here):
    assert here["beside"] == 0


def test_esc_puts_it_back(here):
    assert here["taken back"] == pytest.approx(0, abs=1e-3)


def test_it_stays_in_the_editor(here):
    assert here["share at the edge"] == 0


def test_without_a_line_nothing_is_taken(found):
    assert found["levels"]["without a line"] == 0
