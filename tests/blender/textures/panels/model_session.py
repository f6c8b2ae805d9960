# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: bakes all images, once to the end and once until Esc.

Usage: blender --factory-startup --enable-event-simulate --python model_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import scenes
from window import begun, chosen_in_browser, idle, play, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
FOLDER = RESULT.parent / "levels"


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    without_objects()
    for name in ("First", "Second", "Third"):
        scenes.textured_quad(scenes.image(name, scenes.noise(512, 512)), name)
    bpy.ops.ed.undo_push(message="Scene")
    stage = begun("VIEW_3D")
    window, area = stage.window, stage.area
    area.spaces.active.show_region_ui = True
    yield
    sidebar = next(region for region in area.regions if region.type == "UI")
    sidebar.active_panel_category = "Prefilter"
    yield
    yield
    tab = sidebar.active_panel_category

    override = {"window": window, "area": area}
    options = {"folder": str(FOLDER), "file_format": "tif"}
    with bpy.context.temp_override(**override):
        started = bpy.ops.prefilter.bake_model("INVOKE_DEFAULT", **options)
    yield
    window.event_simulate(type="ESC", value="PRESS")
    yield from until(idle)
    after_cancel = {"images": images(), "files": files()}
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.bake_model("INVOKE_DEFAULT", **options)
    yield from until(idle)
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.bake_model("INVOKE_DEFAULT", result="images")
    yield from until(idle)
    after_bake = {"images": images(), "files": files()}
    with bpy.context.temp_override(**override):
        bpy.ops.ed.undo()
    yield
    yield from stage.menus("TOPBAR_MT_file_export")
    exported = RESULT.parent / "exported"
    exported.mkdir()
    for operator, name in (("export_model", ""), ("export_mipmaps", "one.dds")):
        with bpy.context.temp_override(**override):
            getattr(bpy.ops.prefilter, operator)("INVOKE_DEFAULT")
        yield from chosen_in_browser(exported, name)
    RESULT.write_text(
        json.dumps(
            {
                "tab": tab,
                "started": list(started),
                "after_cancel": after_cancel,
                "after_bake": after_bake,
                "after_undo": images(),
                "exported": sorted(path.name for path in exported.iterdir()),
            }
        )
    )


def images() -> list[str]:
    """Returns the names of the images of the scene."""
    return sorted(one.name for one in bpy.data.images if one.type == "IMAGE")


def files() -> list[str]:
    """Returns the names of the files, finished or not."""
    return sorted(path.name for path in FOLDER.iterdir()) if FOLDER.exists() else []


play(session())
