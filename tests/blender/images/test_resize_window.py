# SPDX-License-Identifier: GPL-3.0-or-later

"""Panel, menu, redo and the modal operator of resizing, in a window that nobody sees."""

from pathlib import Path

SESSION = Path(__file__).with_name("resize_session.py")


def test_panel(found):
    assert not found["polls_without_image"]
    assert found["tab"] == "Prefilter"


def test_works_in_the_background(found):
    assert found["started"] == ["RUNNING_MODAL"]
    assert found["shown"] == "Paint.32x21"


def test_redo(found):
    assert found["filter"] != "box"
    assert found["after_redo"] == ["Paint", "Paint.32x21"]
    assert found["shown_after_redo"] == "Paint.32x21"


def test_undo(found):
    assert found["undone"] == ["Paint"]


def test_esc(found):
    assert found["works"]
    assert found["cancelled"] == ["Paint"]
