# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: presses the buttons of the welcome, then dismisses it.

Usage: blender --factory-startup --enable-event-simulate --python welcome_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
from window import (
    Stage,
    begun,
    clicked,
    command_under,
    idle,
    moved,
    play,
    pressed,
    region,
    until,
)

RESULT = Path(sys.argv[sys.argv.index("--") + 1])

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun("VIEW_3D")
    yield from stage.open_tab()
    found["before"], found["view"] = datablocks(), view(stage)
    for kind in ("mipmaps", "solid", "surface"):
        yield from pressed(stage, f"prefilter.demonstrate(kind='{kind}'")
        yield
        yield from until(idle)
        if kind == "mipmaps":
            yield from until(lambda: any(".mip" in name for name in shown()["images"]))
        yield from stage.redrawn()
        found[kind] = shown()
    yield from undone(stage)
    yield from pressed(stage, "prefilter.end_demonstration(")
    yield from stage.redrawn()
    found["after"], found["view_after"] = datablocks(), view(stage)
    yield from dismissed(stage)
    RESULT.write_text(json.dumps(found))


def shown() -> dict[str, object]:
    """Returns the scene, its closed meshes, and the images that its meshes show."""
    scene = bpy.context.window.scene
    meshes = [obj for obj in scene.objects if obj.type == "MESH" and obj.visible_get()]
    return {
        "scene": scene.name,
        "closed": [obj.name for obj in meshes if bodies.is_closed(obj)],
        "images": [
            node.image.name
            for obj in meshes
            for slot in obj.material_slots
            if slot.material is not None
            for node in slot.material.node_tree.nodes
            if node.type == "TEX_IMAGE"
        ],
    }


def undone(stage: Stage) -> Iterator[None]:
    """Takes the last demonstration back, and does it again."""
    for name in ("undo", "redo"):
        for _ in range(2):
            with bpy.context.temp_override(**stage.override):
                getattr(bpy.ops.ed, name)()
            yield from stage.redrawn()
        found[name] = sorted(obj.name for obj in bpy.context.window.scene.objects)


def dismissed(stage: Stage) -> Iterator[None]:
    """Presses the cross in the header of the welcome."""
    preferences = bpy.context.preferences
    preferences.is_dirty = False
    window, sidebar = stage.window, region(stage.area, "UI")
    for from_right in range(30, 90, 6):
        x, y = sidebar.x + sidebar.width - from_right, sidebar.y + sidebar.height - 16
        yield from moved(window, x, y)
        if command_under(window, stage.area, sidebar).startswith("prefilter.dismiss_welcome("):
            yield from clicked(window, x, y)
            break
    yield from stage.redrawn()
    found["is_shown"] = bpy.types.PREFILTER_PT_welcome.poll(bpy.context)
    found["is_remembered"] = preferences.is_dirty


def view(stage: Stage) -> list[object]:
    """Returns how the 3D view is turned and drawn."""
    space = stage.area.spaces.active
    seen = space.region_3d
    numbers = [*seen.view_rotation, *seen.view_location, seen.view_distance]
    shading = space.shading
    return [*(round(one, 5) for one in numbers), shading.type, shading.color_type]


def datablocks() -> dict[str, list[str]]:
    """Returns the names of the file's data-blocks."""
    kinds = ("scenes", "objects", "meshes", "materials", "images", "curves", "pointclouds")
    return {kind: sorted(one.name for one in getattr(bpy.data, kind)) for kind in kinds}


play(session())
