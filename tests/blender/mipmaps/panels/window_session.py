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

import addon_utils
import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import scenes
from window import cancelled, idle, play, refused, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    assert addon_utils.enable("bl_ext.user_default.prefilter", default_set=True) is not None
    image = scenes.image("Paint", scenes.noise(512, 512))
    scenes.textured_quad(image)
    scenes.textured_quad(scenes.image("Big", scenes.noise(1024, 1024)), "Big")
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "IMAGE_EDITOR"
    area.spaces.active.show_region_ui = True
    yield

    override = {"window": window, "area": area}
    with bpy.context.temp_override(**override):
        polls_without_image = bpy.ops.prefilter.bake_mipmaps.poll()
    area.spaces.active.image = image
    sidebar = next(region for region in area.regions if region.type == "UI")
    sidebar.active_panel_category = "Prefilter"
    yield
    yield
    tab = sidebar.active_panel_category

    with bpy.context.temp_override(**override):
        bpy.ops.wm.call_menu(name="IMAGE_MT_image")
    yield
    window.event_simulate(type="ESC", value="PRESS")
    yield

    with bpy.context.temp_override(**override):
        polls_with_image = bpy.ops.prefilter.bake_mipmaps.poll()
        started = bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", levels=4)
        refused_while_running = refused(bpy.ops.prefilter.bake_mipmaps)
    yield from until(idle)
    after_bake = image_names()

    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", image="Big")
    window.event_simulate(type="ESC", value="PRESS")
    yield from until(idle)
    after_cancel = image_names()

    scene = bpy.context.scene
    scene.frame_set(9)
    endless = {"image": "Big", "use_frames": True, "frame_end": 10**6}
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", **endless)
    yield
    frame_while_reading = scene.frame_current
    yield from cancelled(window, area)
    yield from until(idle)
    frame_after_cancel = scene.frame_current
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.bake_mipmaps(
            "INVOKE_DEFAULT", image="Big", levels=2, use_frames=True, frame_end=3
        )
    yield from until(idle)
    after_frames = image_names()

    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", **endless)
    yield
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    area = max(
        bpy.context.window_manager.windows[0].screen.areas,
        key=lambda area: area.width * area.height,
    )
    area.type = "IMAGE_EDITOR"
    area.spaces.active.image = scenes.image("Big", scenes.noise(1024, 1024))
    scenes.textured_quad(area.spaces.active.image)
    yield
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area):
        bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", image="Big")
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    scenes.image("Next", scenes.noise(2, 2))
    yield
    status = bpy.types.STATUSBAR_HT_header.draw.__module__
    RESULT.write_text(
        json.dumps(
            {
                "polls_without_image": polls_without_image,
                "polls_with_image": polls_with_image,
                "started": list(started),
                "tab": tab,
                "refused_while_running": refused_while_running,
                "after_bake": after_bake,
                "after_cancel": after_cancel,
                "frame_while_reading": frame_while_reading,
                "frame_after_cancel": frame_after_cancel,
                "after_frames": after_frames,
                "status": status,
                "polls_in_next_file": bpy.ops.prefilter.bake_mipmaps.poll(),
                "in_next_file": image_names(),
            }
        )
    )


def image_names() -> list[str]:
    """Returns the names of the images that have pixels."""
    return sorted(image.name for image in bpy.data.images if image.has_data)


play(session())
