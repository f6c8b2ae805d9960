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

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
from window import Stage, begun, held, idle, play, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])


found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    without_objects()
    bodies.sphere("Ball", subdivisions=4)
    properties = next(area for area in stage.window.screen.areas if area.type == "PROPERTIES")
    properties.spaces.active.context = "DATA"
    yield
    yield from drawn(stage)
    yield from voxelized(stage)
    yield from interrupted(stage)
    RESULT.write_text(json.dumps(found))


def drawn(stage: Stage) -> Iterator[None]:
    """Draws the panels and the menus."""
    bpy.data.curves.new("Text", "FONT").body = "Text"
    text = bpy.data.objects.new("Text", bpy.data.curves["Text"])
    bpy.context.scene.collection.objects.link(text)
    bpy.context.view_layer.objects.active = text
    yield from stage.open_tab()
    found["tab_of_a_text"] = stage.tab
    bpy.data.objects.remove(text)
    bpy.context.view_layer.objects.active = bpy.data.objects["Ball"]
    for name in ("PREFILTER_PT_voxelize", "PREFILTER_PT_boolean"):
        with bpy.context.temp_override(**stage.override):
            bpy.ops.wm.call_panel(name=name, keep_open=True)
        yield
        stage.escape()
        yield
    yield from stage.menus("VIEW3D_MT_object", "PREFILTER_MT_object")


def voxelized(stage: Stage) -> Iterator[None]:
    """Voxelizes an object, undoes that, and cancels another run."""
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**stage.override):
        found["polls_alone"] = bpy.ops.prefilter.boolean.poll()
        found["started"] = list(bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=6))
    yield from until(idle)
    found["closed"] = bodies.is_closed(bpy.data.objects["Ball"])
    found["after"] = vertices()
    bpy.ops.ed.undo()
    yield
    found["undone"] = vertices()
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=9)
        stage.escape()
        yield from until(idle)
    found["cancelled"] = vertices()


def interrupted(stage: Stage) -> Iterator[None]:
    """Removes an operand while it is combined, and loads a file while an object is voxelized."""
    bodies.cube("Goes", location=(0, 0, 5))
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.boolean("INVOKE_DEFAULT", operation="union", depth=5)
    bpy.data.objects.remove(bpy.data.objects["Goes"])
    yield from until(idle)
    found["without_operand"] = vertices()

    bpy.data.objects["Ball"].select_set(True)
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=9)
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    bodies.cube("Next")
    yield
    found["polls_in_next_file"] = bpy.ops.prefilter.voxelize.poll()
    found["in_next_file"] = {obj.name: len(obj.data.vertices) for obj in bpy.data.objects}


def vertices() -> int:
    """Returns how many vertices the object has."""
    return len(bpy.data.objects["Ball"].data.vertices)


play(session())
