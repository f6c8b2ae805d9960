# SPDX-License-Identifier: GPL-3.0-or-later

"""Panels, redo and the modal operators of resampling and tables, in a window that nobody sees."""

from pathlib import Path

SESSION = Path(__file__).with_name("resample_session.py")


def test_panel(found):
    assert not found["polls_without_image"]
    assert found["tab"] == "Prefilter"


def test_works_in_the_background(found):
    assert found["started"] == ["RUNNING_MODAL"]
    assert (found["shown"], found["size"]) == ("Paint.transformed", [48, 32])


def test_redo(found):
    assert found["size_after_redo"] != [48, 32]
    assert found["after_redo"] == ["Paint", "Paint.transformed"]


def test_undo(found):
    assert found["undone"] == ["Paint"]


def test_esc(found):
    assert found["works"]
    assert found["cancelled"] == ["Paint"]


def test_tables(found):
    assert found["text"] == "tent-4.glsl"
    assert found["table_works"]
    assert found["texts"] == ["tent-4.glsl"]
