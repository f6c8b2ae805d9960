# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws the panel, and bakes through the modal operator.

One bake runs to its end, one is cancelled by Esc, and one by loading another file; the same while
frames are read.

Usage: blender --factory-startup --enable-event-simulate --python window_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import scenes
from window import Stage, begun, cancelled, held, idle, largest, play, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])


found: dict[str, object] = {}
ENDLESS = {"image": "Big", "use_frames": True, "frame_end": 10**6}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    image = scenes.image("Paint", scenes.noise(512, 512))
    scenes.textured_quad(image)
    scenes.textured_quad(scenes.image("Big", scenes.noise(1024, 1024)), "Big")
    stage = begun("IMAGE_EDITOR")
    yield
    with bpy.context.temp_override(**stage.override):
        found["polls_without_image"] = bpy.ops.prefilter.bake_mipmaps.poll()
    stage.area.spaces.active.image = image
    yield from stage.open_tab()
    found["tab"] = stage.tab
    yield from stage.menus("IMAGE_MT_image")
    yield from baked(stage)
    yield from baked_over_frames(stage)
    yield from interrupted_by_files(stage)
    RESULT.write_text(json.dumps(found))


def baked(stage: Stage) -> Iterator[None]:
    """Bakes an image, and cancels the bake of another."""
    with bpy.context.temp_override(**stage.override):
        found["polls_with_image"] = bpy.ops.prefilter.bake_mipmaps.poll()
        found["started"] = list(bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", levels=4))
    yield from until(idle)
    found["after_bake"] = image_names()
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", image="Big")
        stage.escape()
        yield from until(idle)
    found["after_cancel"] = image_names()


def baked_over_frames(stage: Stage) -> Iterator[None]:
    """Cancels a bake that reads frame after frame, and has one read few of them."""
    scene = bpy.context.scene
    scene.frame_set(9)
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", **ENDLESS)
    yield from until(lambda: scene.frame_current != 9)
    found["frame_while_reading"] = scene.frame_current
    yield from cancelled(stage.window, stage.area)
    yield from until(idle)
    found["frame_after_cancel"] = scene.frame_current
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.bake_mipmaps(
            "INVOKE_DEFAULT", image="Big", levels=2, use_frames=True, frame_end=3
        )
    yield from until(idle)
    found["after_frames"] = image_names()


def interrupted_by_files(stage: Stage) -> Iterator[None]:
    """Loads files while an image is read, and while another is computed."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", **ENDLESS)
    yield
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    stage = largest("IMAGE_EDITOR")
    space = stage.area.spaces.active
    space.image = scenes.image("Big", scenes.noise(1024, 1024))
    scenes.textured_quad(space.image)
    yield
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", image="Big")
        bpy.ops.wm.read_homefile(use_empty=True)
        yield
    scenes.image("Next", scenes.noise(2, 2))
    yield
    found["status"] = bpy.types.STATUSBAR_HT_header.draw.__module__
    found["polls_in_next_file"] = bpy.ops.prefilter.bake_mipmaps.poll()
    found["in_next_file"] = image_names()


def image_names() -> list[str]:
    """Returns the names of the images that have pixels."""
    return sorted(image.name for image in bpy.data.images if image.has_data)


play(session())
