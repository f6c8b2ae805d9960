# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: imports a file of points that the file browser names.

It is then thinned in Adjust Last Operation, undone, and imported with a surface of it.

Usage: blender --factory-startup --enable-event-simulate --python import_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import clouds
import window as windows
from window import (
    Stage,
    begun,
    chosen_in_browser,
    held,
    idle,
    left_browser,
    play,
    until,
    without_objects,
)

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
windows.SECONDS_PER_STEP = 0.05


found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    without_objects()
    clouds.file(RESULT.with_name("Torus.xyz"), *clouds.torus(3_000))
    bpy.context.scene.prefilter_reconstruct.depth = 5
    yield from stage.menus("TOPBAR_MT_file_import")
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.import_points("INVOKE_DEFAULT")
    yield from left_browser()
    found["not_imported"] = objects()
    yield from imported(stage)
    found["imported"] = objects()
    found["plain"] = shading(stage)
    bpy.ops.ed.undo()
    yield
    found["undone"] = objects()
    yield from imported(stage, use_reconstruct=True)
    yield from until(idle)
    found["surface"] = objects()
    found["adjusted"] = bpy.context.window_manager.operators[-1].bl_idname
    yield from dropped(stage)
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.import_points(
                "INVOKE_DEFAULT", filepath=str(RESULT.with_name("Torus.xyz"))
            )
        found["works"] = not idle()
        stage.escape()
        yield from until(idle)
    found["cancelled"] = objects()
    yield from colored(stage)
    RESULT.write_text(json.dumps(found))


def imported(stage: Stage, **options: object) -> Iterator[None]:
    """Imports the file by the browser, a window of its own."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.import_points("INVOKE_DEFAULT", **options)
    yield from chosen_in_browser(RESULT.parent, "Torus.xyz")


def dropped(stage: Stage) -> Iterator[None]:
    """Simulates a drop of files, and chooses from the menu by its letters."""
    handler = bpy.types.PREFILTER_FH_points
    name = handler.bl_import_operator.partition(".")[2]
    for letter in "IR":
        without_objects()
        with bpy.context.temp_override(**stage.override):
            found[f"takes_{letter}"] = handler.poll_drop(bpy.context)
            getattr(bpy.ops.prefilter, name)(
                "INVOKE_DEFAULT", directory=str(RESULT.parent), files=[{"name": "Torus.xyz"}]
            )
        yield
        yield
        stage.window.event_simulate(type=letter, value="PRESS", unicode=letter.lower())
        yield
        yield from until(idle)
        yield
        yield from until(idle)
        found[f"dropped_{letter}"] = objects()


def colored(stage: Stage) -> Iterator[None]:
    """Imports points with colors; makes a surface of them in Solid mode."""
    without_objects()
    positions, normals = clouds.torus(3_000)
    colors = np.round(255 * (positions + 1.5) / 3)
    path = clouds.file(RESULT.with_name("Colored.xyz"), positions, normals, colors)
    for wanted in (False, True):
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.import_points(
                "INVOKE_DEFAULT", filepath=str(path), use_show_colors=wanted
            )
        yield from until(idle)
        yield
        found[f"colored_{wanted}"] = shading(stage)
    stage.area.spaces.active.shading.type = "SOLID"
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.reconstruct("INVOKE_DEFAULT", depth=5)
    yield from until(idle)
    yield
    found["surface_colored"] = shading(stage)


def shading(stage: Stage) -> list[str]:
    """Returns how the editor shows objects."""
    found = stage.area.spaces.active.shading
    return [found.type, found.color_type]


def objects() -> dict[str, bool]:
    """Returns the objects, and whether they are hidden."""
    return {obj.name: obj.hide_get() for obj in bpy.data.objects}


play(session())
