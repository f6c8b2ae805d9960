# SPDX-License-Identifier: GPL-3.0-or-later

"""Panel, menus, redo and the modal operator of scans, in a window that nobody sees."""

from pathlib import Path

SESSION = Path(__file__).with_name("scan_session.py")


def test_panel(found):
    assert found["tab"] == "Prefilter"


def test_works_in_the_background(found):
    assert found["started"] == ["RUNNING_MODAL"]
    assert found["objects"] == {"Scan": True, "Scan.surface": False}
    assert found["closed"]


def test_redo(found):
    before, depth = found["before_redo"]
    after, new_depth = found["after_redo"]
    assert abs(new_depth - depth) == 1
    # Cells are no smaller than the points are apart.
    assert (after > before) == (new_depth > depth)
    assert (after < before) == (new_depth < depth)


def test_undo(found):
    assert found["undone"] == {"Scan": False}


def test_esc(found):
    assert found["works"]
    assert found["cancelled"] == {"Scan": False}


def test_an_object_deleted_meanwhile(found):
    assert found["gone"] == {}
