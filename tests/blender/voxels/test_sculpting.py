# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxelizing in Sculpt Mode, in an unseen window: the results of undo and redo."""

from pathlib import Path

SESSION = Path(__file__).with_name("sculpt_session.py")
BALL = 642


def test_the_tab_has_the_panel(found):
    assert found["tab"] == "Prefilter"
    assert not found["nothing"]


def test_undo_and_redo(found):
    """Before the result there is a step with the mesh as it was, mask and all."""
    plain, masked, voxelized, cleared = found["states"]
    assert plain == ["SCULPT", BALL, 0.0]
    assert masked == ["SCULPT", BALL, 1.0]
    mode, count, mask = voxelized
    assert (mode, mask) == ("SCULPT", 1.0)
    assert count > BALL
    assert cleared == ["SCULPT", count, 0.0]
    assert found["undone"] == [voxelized, masked, masked, plain]
    assert found["redone"] == [masked, masked, voxelized, cleared]


def test_adjust_last_operation(found):
    before, after, undone = found["changed"]
    assert after[0] == undone[0] == "SCULPT"
    assert after[1] > 2 * before[1]
    assert undone[1] < after[1]


def test_strokes_are_blocked_while_voxelizing(found):
    """Strokes would be lost."""
    before, during, after = found["alone"]
    assert before == during == after
