# SPDX-License-Identifier: GPL-3.0-or-later

"""Panels, menus and modal operators of voxels, in a window that nobody sees."""

from pathlib import Path

SESSION = Path(__file__).with_name("voxel_session.py")


def test_panels_and_modal_operators(found):
    vertices = 642
    assert found["tab_of_a_text"] == "Prefilter"
    assert found["started"] == ["RUNNING_MODAL"]
    assert not found["polls_alone"]
    assert found["closed"]
    assert found["after"] != vertices
    assert found["undone"] == vertices
    assert found["cancelled"] == vertices
    assert found["without_operand"] == vertices
    assert found["polls_in_next_file"]
    assert found["in_next_file"] == {"Next": 8}
