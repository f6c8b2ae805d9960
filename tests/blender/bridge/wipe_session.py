# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: drags the line of both wipes with the mouse.

Usage: blender --factory-startup --enable-event-simulate --python wipe_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import scenes
import window as windows
from window import Stage, begun, idle, moved, play, region, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
windows.SECONDS_PER_STEP = 0.05
SCREEN_MIDDLE = 640, 400

found: dict[str, dict[str, object]] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun("IMAGE_EDITOR")
    image = scenes.image("Paint", scenes.noise(64, 64))
    scenes.textured_quad(image)
    stage.area.spaces.active.image = image
    yield
    manager = bpy.context.window_manager
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.preview_levels("INVOKE_DEFAULT", compare="tent")
    yield from until(idle)
    view = manager.prefilter_view
    view.compare, view.use_wipe, view.wipe = "tent", True, 0.5
    yield from dragged(stage, view, "levels")
    view.use_wipe = False
    yield from stage.redrawn()
    found["levels"]["without a line"] = yield from dragged_by(stage, view.wipe, 50, view)
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.end_preview()
        bpy.ops.prefilter.preview_plane("INVOKE_DEFAULT", filter="lanczos2")
    yield from until(idle)
    yield from dragged(stage, manager.prefilter_plane, "plane")
    RESULT.write_text(json.dumps(found))


def dragged(stage: Stage, state: bpy.types.PropertyGroup, name: str) -> Iterator[None]:
    """Drags a line, off and on it, slowly, and takes it back; keeps by how many pixels it moved."""
    here = found[name] = {}
    width = region(stage.area, "WINDOW").width
    state.wipe = 0.5
    x, y = line(stage, state.wipe)
    yield from moved(stage.window, x, y)
    yield from moved(stage.window, x - 90, y)
    off, pointer = (yield from windows.picture(stage.area)), windows.Pointer()
    elsewhere = pointer.serial()

    def changed() -> NDArray[np.bool_]:
        differs = np.any(windows.pixels(stage.area) != off, axis=-1)
        # The server draws its pointer in the middle of the screen, and hides it at times.
        part = region(stage.area, "WINDOW")
        column, row = SCREEN_MIDDLE[0] - part.x, SCREEN_MIDDLE[1] - part.y
        differs[row - 32 : row + 32, column - 32 : column + 32] = False
        return differs

    yield from moved(stage.window, x, y)
    # The server hears of it sooner or later.
    yield from until(lambda: pointer.serial() != elsewhere)
    yield from until(lambda: np.mean(changed()[:, width // 2]) > 0.8)
    yield from moved(stage.window, x - 90, y)
    yield from until(lambda: pointer.serial() == elsewhere)
    yield from until(lambda: not changed().any())
    here["shows that it can be taken"] = True
    here["dragged"] = yield from dragged_by(stage, state.wipe, 60, state)
    here["beside"] = yield from dragged_by(stage, state.wipe + 0.1, -60, state)
    here["near"] = yield from dragged_by(stage, state.wipe, -40, state, off=4)
    here["slowly"] = yield from dragged_by(stage, state.wipe, 50, state, key="SHIFT")
    state.wipe = 0.5
    yield from dragged_by(stage, state.wipe, round(0.1 * width), state, key="CTRL")
    here["share snapped"] = state.wipe
    here["taken back"] = yield from dragged_by(stage, state.wipe, 50, state, end="ESC")
    here["out of the window"] = yield from dragged_by(stage, state.wipe, -5000, state)
    here["share at the edge"] = state.wipe


def dragged_by(
    stage: Stage,
    share: float,
    step: int,
    state: bpy.types.PropertyGroup,
    *,
    off: int = 0,
    end: str = "LEFTMOUSE",
    key: str = "",
) -> Iterator[None]:
    """Drags from a share of the width, and returns by how many pixels the line has moved."""
    before = state.wipe
    x, y = line(stage, share)
    x += off
    window = stage.window
    keys = {key.lower(): True} if key else {}
    yield from moved(window, x - 30, y - 90)
    yield from moved(window, x, y)
    window.event_simulate(type="LEFTMOUSE", value="PRESS", x=x, y=y)
    yield
    for part in (0.5, 1.0):
        x_there = x + round(part * step)
        if key:
            window.event_simulate(type=f"LEFT_{key}", value="PRESS", x=x, y=y, **keys)
        window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x_there, y=y, **keys)
        yield
    value = "RELEASE" if end == "LEFTMOUSE" else "PRESS"
    window.event_simulate(type=end, value=value, x=x + step, y=y)
    yield
    if end != "LEFTMOUSE":
        window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=x + step, y=y)
        yield
    if key:
        window.event_simulate(type=f"LEFT_{key}", value="RELEASE", x=x, y=y)
        yield
    return (state.wipe - before) * region(stage.area, "WINDOW").width


def line(stage: Stage, share: float) -> tuple[int, int]:
    """Returns where in the window a line is."""
    part = region(stage.area, "WINDOW")
    return part.x + round(share * part.width), part.y + part.height // 3


play(session())
