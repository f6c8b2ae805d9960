# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender 5.2 with a window: draws the panel, and bakes into the texture cache.

One bake runs to its end, one is cancelled by Esc, and one by loading another file.

Usage: blender --factory-startup --enable-event-simulate --python cache_session.py -- FOLDER
FOLDER gets result.json.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import cycles_scenes as cycles
import scenes
from window import Stage, begun, held, idle, largest, play, until, without_objects

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])


found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.use_texture_cache = False
    without_objects()
    for material in list(bpy.data.materials):
        bpy.data.materials.remove(material)
    cycles.shown_on(picture("small.png", 256))
    stage = begun("PROPERTIES")
    stage.area.spaces.active.context = "RENDER"
    yield
    with bpy.context.temp_override(**stage.override):
        bpy.ops.wm.call_panel(name="PREFILTER_PT_texture_cache", keep_open=True)
    yield
    yield
    stage.escape()
    yield
    yield from baked(stage)
    yield from interrupted(stage)
    yield from packed(stage)
    (FOLDER / "result.json").write_text(json.dumps(found))


def baked(stage: Stage) -> Iterator[None]:
    """Bakes into the cache."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.render.generate_texture_cache()
        box = contents()
        found["started"] = list(bpy.ops.prefilter.bake_texture_cache("INVOKE_DEFAULT"))
    yield from until(idle)
    made = contents()
    found["same_files"] = sorted(made) == sorted(box)
    found["replaced"] = [name for name in box if made[name] != box[name]]
    found["cache_after_bake"] = bpy.context.scene.render.use_texture_cache


def interrupted(stage: Stage) -> Iterator[None]:
    """Cancels a bake by Esc, and another one by loading a file."""
    scene = bpy.context.scene
    scene.render.use_texture_cache = False
    bpy.data.objects["Quad"].data.materials[0] = cycles.emission("Big", picture("big.png", 64))
    with bpy.context.temp_override(**stage.override):
        bpy.ops.render.generate_texture_cache()
        before = contents()
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.bake_texture_cache("INVOKE_DEFAULT")
        yield
        stage.escape()
        yield from until(idle)
    found["cancelled_leaves_files"] = contents() == before
    found["cache_after_cancel"] = scene.render.use_texture_cache

    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.bake_texture_cache("INVOKE_DEFAULT")
        bpy.ops.wm.read_homefile(use_empty=True)
        yield
    scenes.image("Next", scenes.noise(2, 2))
    yield
    found["polls_in_next_file"] = bpy.ops.prefilter.bake_texture_cache.poll()
    found["next_file_leaves_files"] = contents() == before


def packed(stage: Stage) -> Iterator[None]:
    """Presses the button where the only image is packed: the menu that opens has the remedy."""
    without_objects()
    image = picture("packed.png", 64)
    image.pack()
    cycles.shown_on(image)
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "scene.blend"))
    yield
    stage = largest()
    with bpy.context.temp_override(**stage.override):
        found["asked"] = list(bpy.ops.prefilter.bake_texture_cache("INVOKE_DEFAULT"))
    yield
    for key in ("DOWN_ARROW", "RET"):
        stage.window.event_simulate(type=key, value="PRESS")
        yield
        yield
    yield from until(idle)
    found["unpacked"] = not image.packed_file


def picture(name: str, side: int) -> bpy.types.Image:
    """Writes noise to a file and loads it."""
    return cycles.write_picture(FOLDER / name, scenes.noise(side, side)[..., :3], "uint8")


def contents() -> dict[str, int]:
    """Returns a hash of each cache file."""
    folder = FOLDER / "blender_tx"
    return {path.name: hash(path.read_bytes()) for path in sorted(folder.iterdir())}


play(session())
