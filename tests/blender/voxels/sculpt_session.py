# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: voxelizes in Sculpt Mode, between brushes, with undo and redo.

Usage: blender --factory-startup --enable-event-simulate --python sculpt_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
from window import RedoPanel, Stage, begun, held, idle, play, region, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun("VIEW_3D")
    without_objects()
    bodies.sphere("Ball", subdivisions=4)
    bpy.ops.ed.undo_push(message="ball")
    yield
    with bpy.context.temp_override(**stage.override):
        bpy.ops.object.mode_set("EXEC_DEFAULT", True, mode="SCULPT")
    yield
    yield from panels(stage)
    yield from there_and_back(stage)
    yield from redone(stage)
    yield from left_alone(stage)
    RESULT.write_text(json.dumps(found))


def panels(stage: Stage) -> Iterator[None]:
    """Draws the tab and the menu."""
    yield from stage.open_tab()
    found["tab"] = stage.tab
    found["nothing"] = bpy.types.PREFILTER_PT_nothing.poll(bpy.context)
    yield from stage.menus("VIEW3D_MT_sculpt")


def there_and_back(stage: Stage) -> Iterator[None]:
    """Masks, voxelizes, clears the mask, and takes each step back and forth."""
    states = [state()]
    for step in (masked, voxelized, cleared):
        yield from step(stage)
        states.append(state())
    found["states"] = states
    found["undone"] = []
    for _ in range(4):
        bpy.ops.ed.undo()
        yield
        yield
        found["undone"].append(state())
    found["redone"] = []
    for _ in range(4):
        bpy.ops.ed.redo()
        yield
        yield
        found["redone"].append(state())


def redone(stage: Stage) -> Iterator[None]:
    """Changes the depth in the redo panel, and undoes that."""
    yield from voxelized(stage)
    before = state()
    panel = RedoPanel(stage.window, stage.area)
    yield from panel.unfolded()
    yield from panel.step("depth")
    yield
    told = found["changed"] = [before, state()]
    bpy.ops.ed.undo()
    yield
    yield
    told.append(state())


def left_alone(stage: Stage) -> Iterator[None]:
    """Presses Tab while it works, which leads nowhere then, and cancels it."""
    before = state()
    area = region(stage.area, "WINDOW")
    x, y = area.x + area.width // 2, area.y + area.height // 2
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", True, depth=8)
        yield
        stage.window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
        for value in ("PRESS", "RELEASE"):
            stage.window.event_simulate(type="TAB", value=value, x=x, y=y)
        yield
        yield
        during = state()
        stage.escape()
        yield from until(idle)
    found["alone"] = [before, during, state()]


def masked(stage: Stage) -> Iterator[None]:
    """Masks half of the ball: a step of Sculpt Mode of its own."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.paint.mask_flood_fill("EXEC_DEFAULT", True, mode="VALUE", value=1.0)
    yield


def cleared(stage: Stage) -> Iterator[None]:
    """Clears the mask."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.paint.mask_flood_fill("EXEC_DEFAULT", True, mode="VALUE", value=0.0)
    yield


def voxelized(stage: Stage) -> Iterator[None]:
    """Voxelizes as the button does."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", True, depth=5)
    yield from until(idle)
    yield


def state() -> list[object]:
    """Returns the mode, how many vertices there are, and the sum of the mask."""
    obj = bpy.context.view_layer.objects.active
    mesh = obj.data
    mask = mesh.attributes.get(".sculpt_mask")
    values = np.zeros(len(mesh.vertices), np.float32)
    if mask is not None:
        mask.data.foreach_get("value", values)
    return [obj.mode, len(mesh.vertices), round(float(values.mean()), 3)]


play(session())
