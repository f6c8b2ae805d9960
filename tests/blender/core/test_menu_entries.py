# SPDX-License-Identifier: GPL-3.0-or-later

"""Every menu entry, panel and file handler that is registered is opened, with real files."""

import os
from pathlib import Path

import bpy
import entries
import pytest
import scan_files

SESSION = Path(__file__).with_name("menus_session.py")
LONG = pytest.mark.skipif(
    not os.environ.get("PREFILTER_TEST_ALL"), reason="minutes: run with PREFILTER_TEST_ALL only"
)
NEEDS_CACHE = set() if entries.HAS_CACHE else {"prefilter.bake_texture_cache"}


@LONG
def test_menu_entries_work_in_a_window(found):
    """Each ends with a report, or at once, and none fails."""
    assert not found["silent"]
    assert not found["problems"]
    assert len(found["calls"]) > 40
    bad = [one for one in found["calls"] if not ended_well(one)]
    assert not bad, bad


def ended_well(call):
    if call["operator"] in NEEDS_CACHE:
        return not call["polls"]
    # A key ends a drag operation; without one, nothing is reported.
    key = entries.CASES[call["operator"].removeprefix("prefilter.")].key
    is_done = "FINISHED" in call.get("begun", ()) or call.get("done") or key
    return call["polls"] and is_done and not call["browses"]


@LONG
def test_menus_open_in_a_window(found):
    assert set(found["entries"]) == set(found["drawn_entries"])


@LONG
def test_panels_open_in_a_window(found):
    assert set(found["panels"]) == set(found["drawn"])


@LONG
def test_file_handlers_work_in_a_window(found):
    assert {one["handler"] for one in found["dropped"]} == {
        handler.__name__ for handler in entries.handlers()
    }
    for one in found["dropped"]:
        assert len(one["editors"]) == 1, one
        if one["editors"] == ["VIEW_3D"]:
            assert one["points"] == [scan_files.COUNT], one
        else:
            assert len(one["images"]) == 1, one


@pytest.fixture
def area():
    return bpy.context.window_manager.windows[0].screen.areas[0]


@LONG
def test_menu_entries_work(area, tmp_path):
    """Menu entries also work without a window."""
    offered, silent = entries.calls(area)
    assert not silent
    for call in offered:
        case = entries.case_of(call)
        if call.operator in NEEDS_CACHE or case.key or "shortcut" in call.operator:
            continue
        entries.clear()
        shown = case.scene()
        settings = {}
        if case.file == "/":
            settings["directory"] = f"{tmp_path}/"
        elif case.file:
            path = tmp_path / case.file
            if path.suffix in {".svg", ".xyz"}:
                entries.write_file(path)
            settings["filepath"] = str(path)
        with entries.editor(area, entries.editor_of(call.menu), shown):
            settings = call.properties_now() | settings
            done = entries.operator_of(call.operator)("EXEC_DEFAULT", **settings)
        assert done == {"FINISHED"}, call


def test_panels_draw(area):
    drawn = set()
    for scene in entries.PANEL_SCENES:
        entries.clear()
        shown = scene()
        for panel in entries.panels():
            kind = panel.bl_space_type
            with entries.editor(area, kind, shown):
                if not all(polls(one) for one in (panel, *own_ancestors(panel))):
                    continue
                stand_in = entries.Shown(panel)
                for part in ("draw_header", "draw_header_preset", "draw"):
                    if hasattr(panel, part):
                        getattr(panel, part)(stand_in, bpy.context)
            drawn.add(panel.__name__)
    # The queue is in windows only.
    missing = {panel.__name__ for panel in entries.panels()} - drawn
    assert missing == {"PREFILTER_PT_queue", "PREFILTER_PT_queue_of_images"}


def polls(panel):
    return not hasattr(panel, "poll") or panel.poll(bpy.context)


def own_ancestors(panel):
    return [one for one in entries.ancestors(panel) if entries.is_own(one)]


@pytest.mark.parametrize("kind", ["PREFILTER_FH_points", "PREFILTER_FH_svg"])
def test_file_handlers_work(kind, tmp_path):
    """Blender compares a file's last extension with the handlers', and one of these matches."""
    handler = getattr(bpy.types, kind)
    operator = entries.operator_of(handler.bl_import_operator)
    for extension in handler.bl_file_extensions.split(";"):
        assert os.path.splitext(f"a{extension}")[1] == extension
        entries.clear()
        path = entries.write_dropped(tmp_path, extension)
        assert operator("EXEC_DEFAULT", **entries.as_dropped(operator, path)) == {"FINISHED"}
        assert len(bpy.data.objects) + len(bpy.data.images) == 1


def test_every_file_handler_is_tested():
    names = {handler.__name__ for handler in entries.handlers()}
    assert names == {"PREFILTER_FH_points", "PREFILTER_FH_svg"}
