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

import addon_utils
import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import cycles_scenes as cycles
import scenes
from window import idle, play, refused, until

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    assert addon_utils.enable("bl_ext.user_default.prefilter", default_set=True) is not None
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.use_texture_cache = False
    for obj in list(scene.objects):
        bpy.data.objects.remove(obj)
    for material in list(bpy.data.materials):
        bpy.data.materials.remove(material)
    small = picture("small.png", 256)
    cycles.shown_on(small)
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "PROPERTIES"
    area.spaces.active.context = "RENDER"
    yield
    region = next(region for region in area.regions if region.type == "WINDOW")
    override = {"window": window, "area": area, "region": region}

    with bpy.context.temp_override(**override):
        bpy.ops.wm.call_panel(name="PREFILTER_PT_texture_cache", keep_open=True)
    yield
    yield
    window.event_simulate(type="ESC", value="PRESS")
    yield

    with bpy.context.temp_override(**override):
        bpy.ops.render.generate_texture_cache()
        box = contents()
        started = bpy.ops.prefilter.bake_texture_cache("INVOKE_DEFAULT")
        refused_while_running = refused(bpy.ops.prefilter.bake_texture_cache)
    yield from until(idle)
    baked = contents()
    cache_after_bake = scene.render.use_texture_cache

    scene.render.use_texture_cache = False
    bpy.data.objects["Quad"].data.materials[0] = cycles.emission("Big", picture("big.png", 2048))
    with bpy.context.temp_override(**override):
        bpy.ops.render.generate_texture_cache()
        before_cancel = contents()
        bpy.ops.prefilter.bake_texture_cache("INVOKE_DEFAULT")
    yield
    window.event_simulate(type="ESC", value="PRESS")
    yield from until(idle)
    after_cancel = contents()
    cache_after_cancel = scene.render.use_texture_cache

    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.bake_texture_cache("INVOKE_DEFAULT")
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    scenes.image("Next", scenes.noise(2, 2))
    yield
    (FOLDER / "result.json").write_text(
        json.dumps(
            {
                "started": list(started),
                "refused_while_running": refused_while_running,
                "same_files": sorted(baked) == sorted(box),
                "replaced": [name for name in box if baked[name] != box[name]],
                "cache_after_bake": cache_after_bake,
                "cancelled_leaves_files": after_cancel == before_cancel,
                "cache_after_cancel": cache_after_cancel,
                "polls_in_next_file": bpy.ops.prefilter.bake_texture_cache.poll(),
                "next_file_leaves_files": contents() == before_cancel,
            }
        )
    )


def picture(name: str, side: int) -> bpy.types.Image:
    """Writes noise to a file and loads it."""
    return cycles.write_picture(FOLDER / name, scenes.noise(side, side)[..., :3], "uint8")


def contents() -> dict[str, int]:
    """Returns a hash of each cache file."""
    folder = FOLDER / "blender_tx"
    return {path.name: hash(path.read_bytes()) for path in sorted(folder.iterdir())}


play(session())
