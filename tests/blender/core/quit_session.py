# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: quits while work is paused and more waits.

Usage: blender --factory-startup --enable-event-simulate --python quit_session.py -- RESULT.json
"""

import importlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
from window import PACKAGE, begun, play, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    without_objects()
    bodies.sphere("Ball", subdivisions=5)
    queue = importlib.import_module(f"{PACKAGE}.core.queue")
    for _ in range(2):
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=9)
    yield from until(lambda: bool(queue.listed()) and queue.listed()[0].run is not None)
    switches = bpy.context.window_manager.prefilter_switches
    switches.use_pause[queue.listed()[0].switches._index] = True
    yield from until(lambda: queue.listed()[0].run.text.startswith("Paused"))
    RESULT.write_text(json.dumps([job.state.name for job in queue.listed()]))
    bpy.context.preferences.view.use_save_prompt = False
    with bpy.context.temp_override(window=stage.window):
        bpy.ops.wm.quit_blender()
    yield


play(session())
