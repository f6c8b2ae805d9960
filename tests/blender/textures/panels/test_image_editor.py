# SPDX-License-Identifier: GPL-3.0-or-later

"""The panel and the modal operator, in a window that nobody sees."""

from pathlib import Path

SESSION = Path(__file__).with_name("window_session.py")


def test_panel_and_modal_bake(found):
    assert found["tab"] == "Prefilter"
    assert not found["polls_without_image"]
    assert found["polls_with_image"]
    assert found["started"] == ["RUNNING_MODAL"]
    assert found["after_bake"] == ["Big", "Paint", "Paint.mip01", "Paint.mip02", "Paint.mip03"]
    assert found["after_cancel"] == found["after_bake"]
    assert found["frame_while_reading"] != 9
    assert found["frame_after_cancel"] == 9
    assert found["after_frames"] == sorted([*found["after_bake"], "Big.mip01"])
    assert not found["status"].startswith("bl_ext")
    assert found["polls_in_next_file"]
    assert found["in_next_file"] == ["Next"]
