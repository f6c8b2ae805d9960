# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws the panel and menus, and reconstructs a surface.

One run ends well and is done again with another depth, one is cancelled by Esc, and one is for an
object that goes meanwhile.

Usage: blender --factory-startup --enable-event-simulate --python scan_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
import clouds
from window import RedoPanel, Stage, begun, held, idle, play, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])


found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    without_objects()
    clouds.scan(*clouds.torus(3_000))
    yield from stage.open_tab()
    found["tab"] = stage.tab
    yield from stage.menus("VIEW3D_MT_object", "PREFILTER_MT_object")
    yield from reconstructed(stage)

    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.reconstruct("INVOKE_DEFAULT", depth=6)
        found["works"] = not idle()
        stage.escape()
        yield from until(idle)
    found["cancelled"] = hidden()

    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.reconstruct("INVOKE_DEFAULT", depth=9)
    bpy.data.objects.remove(bpy.data.objects["Scan"])
    yield from until(idle)
    found["gone"] = hidden()
    RESULT.write_text(json.dumps(found))


def reconstructed(stage: Stage) -> Iterator[None]:
    """Reconstructs a surface, does so again with another depth, and undoes it."""
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**stage.override):
        found["started"] = list(bpy.ops.prefilter.reconstruct("INVOKE_DEFAULT", True, depth=5))
    yield from until(idle)
    yield
    found["objects"] = hidden()
    found["closed"] = bodies.is_closed(bpy.data.objects["Scan.surface"])
    yield from stage.redo_panel()
    panel = RedoPanel(stage.window, stage.area)
    found["before_redo"] = size(panel)
    yield from panel.step("depth")
    found["after_redo"] = size(panel)
    bpy.ops.ed.undo()
    yield
    found["undone"] = hidden()


def hidden() -> dict[str, bool]:
    """Returns the objects, and whether they are hidden."""
    return {obj.name: obj.hide_get() for obj in bpy.data.objects}


def size(panel: RedoPanel) -> tuple[int, int]:
    """Returns how many triangles there are, and at which depth."""
    mesh = bpy.data.objects["Scan.surface"].data
    return len(mesh.polygons), panel.operator.properties.depth


play(session())
