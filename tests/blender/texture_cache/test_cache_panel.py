# SPDX-License-Identifier: GPL-3.0-or-later

"""The panel and the modal bake into the texture cache, in a window that nobody sees."""

import json
from pathlib import Path

import bpy
import pytest

SESSION = Path(__file__).with_name("cache_session.py")


@pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="Blender 5.2 or later is needed")
def test_panel_and_modal_bake_into_the_cache(in_window, tmp_path):
    in_window(SESSION, tmp_path)
    found = json.loads((tmp_path / "result.json").read_text())
    assert found["started"] == ["RUNNING_MODAL"]
    assert found["same_files"]
    assert len(found["replaced"]) == 1
    assert found["cache_after_bake"]
    assert found["cancelled_leaves_files"]
    assert not found["cache_after_cancel"]
    assert found["polls_in_next_file"]
    assert found["next_file_leaves_files"]
    assert found["asked"] == ["CANCELLED"]
    assert found["unpacked"]


@pytest.mark.skipif(bpy.app.version >= (5, 2, 0), reason="this Blender has a texture cache")
def test_an_older_blender_has_no_panel():
    assert not hasattr(bpy.types, "PREFILTER_PT_texture_cache")
