# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws panels and menus, and voxelizes through the operators.

One run ends well, one is cancelled by Esc, one is for an object that goes meanwhile, and one ends
by loading another file.

Usage: blender --factory-startup --enable-event-simulate --python voxel_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import addon_utils
import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
from window import idle, play, refused, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    assert addon_utils.enable("bl_ext.user_default.prefilter", default_set=True) is not None
    clear()
    bodies.sphere("Ball", subdivisions=4)
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    region = next(region for region in area.regions if region.type == "WINDOW")
    properties = next(area for area in window.screen.areas if area.type == "PROPERTIES")
    properties.spaces.active.context = "DATA"
    override = {"window": window, "area": area, "region": region}
    yield
    bpy.data.curves.new("Text", "FONT").body = "Text"
    text = bpy.data.objects.new("Text", bpy.data.curves["Text"])
    bpy.context.scene.collection.objects.link(text)
    bpy.context.view_layer.objects.active = text
    area.spaces.active.show_region_ui = True
    sidebar = next(region for region in area.regions if region.type == "UI")
    yield from until(lambda: sidebar.active_panel_category != "UNSUPPORTED")
    sidebar.active_panel_category = "Prefilter"
    area.tag_redraw()
    yield
    yield
    found = {"tab_of_a_text": sidebar.active_panel_category}
    bpy.data.objects.remove(text)
    bpy.context.view_layer.objects.active = bpy.data.objects["Ball"]
    for name in ("PREFILTER_PT_voxelize", "PREFILTER_PT_boolean"):
        with bpy.context.temp_override(**override):
            bpy.ops.wm.call_panel(name=name, keep_open=True)
        yield
        window.event_simulate(type="ESC", value="PRESS")
        yield
    for name in ("VIEW3D_MT_object", "PREFILTER_MT_object"):
        with bpy.context.temp_override(**override):
            bpy.ops.wm.call_menu(name=name)
        yield
        window.event_simulate(type="ESC", value="PRESS")
        yield

    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**override):
        found["polls_alone"] = bpy.ops.prefilter.boolean.poll()
        found["started"] = list(bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=6))
        found["refused_while_running"] = refused(bpy.ops.prefilter.voxelize)
    yield from until(idle)
    ball = bpy.data.objects["Ball"]
    found["closed"] = bodies.is_closed(ball)
    found["after"] = len(ball.data.vertices)
    bpy.ops.ed.undo()
    yield
    found["undone"] = len(bpy.data.objects["Ball"].data.vertices)

    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=9)
    window.event_simulate(type="ESC", value="PRESS")
    yield from until(idle)
    found["cancelled"] = len(bpy.data.objects["Ball"].data.vertices)

    bodies.cube("Goes", location=(0, 0, 5))
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.boolean("INVOKE_DEFAULT", operation="union", depth=5)
    bpy.data.objects.remove(bpy.data.objects["Goes"])
    yield from until(idle)
    found["without_operand"] = len(bpy.data.objects["Ball"].data.vertices)

    bpy.data.objects["Ball"].select_set(True)
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=9)
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    bodies.cube("Next")
    yield
    found["polls_in_next_file"] = bpy.ops.prefilter.voxelize.poll()
    found["in_next_file"] = {obj.name: len(obj.data.vertices) for obj in bpy.data.objects}
    RESULT.write_text(json.dumps(found))


def clear() -> None:
    """Removes the objects of the file that Blender starts with."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)


play(session())
