# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws the preview plane, and saves the pixels.

Usage: blender --factory-startup --enable-event-simulate --python plane_session.py -- RESULT.npz
"""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
import gpu
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import scenes
from window import PACKAGE, begun, idle, picture, play, region, until

RESULT = sys.argv[sys.argv.index("--") + 1]
WIDTH, HEIGHT = 64, 48  # Of an offscreen picture.
VIEWS = ((0.0, 0.1, 0.37), (1.2, 0.3, 2.0), (1.45, 2.0, 6.0))  # Tilt, rotation, tiles.

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun("IMAGE_EDITOR", opened="PREFILTER_PT_plane")
    window, area = stage.window, stage.area
    planes = importlib.import_module(f"{PACKAGE}.images.view.plane")
    image = scenes.image("Wide", scenes.noise(24, 43))
    # Blender reports changes of data that the scene uses.
    scenes.textured_quad(image)
    other = scenes.image("High", scenes.noise(33, 7, alpha=True, seed=2))
    area.spaces.active.image = image
    area.spaces.active.show_region_ui = True
    yield
    sidebar = region(area, "UI")
    yield from until(lambda: sidebar.active_panel_category != "UNSUPPORTED")
    sidebar.active_panel_category = "Prefilter"
    override = {"window": window, "area": area, "region": region(area, "WINDOW")}
    with bpy.context.temp_override(**override):
        found["end polls"] = bpy.ops.prefilter.end_plane.poll()
        started = bpy.ops.prefilter.preview_plane("INVOKE_DEFAULT", filter="lanczos2")
        found["started"] = sorted(started)
    yield from until(idle)
    yield
    found["on screen"] = yield from picture(area)
    settings = bpy.context.window_manager.prefilter_plane
    settings.use_plane = False
    found["off screen"] = yield from picture(area)
    settings.use_plane = True

    with bpy.context.temp_override(**override):
        area.spaces.active.image = other
        bpy.ops.prefilter.preview_plane(filter="tent")
    for name, one in (("wide", image), ("high", other)):
        for index, view in enumerate(VIEWS):
            for texels in (4, 8):
                yield from offscreen(planes.find(one), view, texels, f"{name} {index} {texels}")

    found["stale before painting"] = planes.find(image).is_stale
    image.pixels.foreach_set(scenes.noise(24, 43, seed=9).ravel())
    image.update()
    image.update_tag()
    yield
    found["stale after painting"] = planes.find(image).is_stale
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.end_plane()
    found["ended"] = planes.find(other) is None
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    found["kept in next file"] = len(planes._planes)
    np.savez(RESULT, **found)


def offscreen(plane: object, view: tuple[float, ...], texels: int, name: str) -> Iterator[None]:
    """Draws a plane where nothing is rounded to bytes."""
    overlay = importlib.import_module(f"{PACKAGE}.images.view.overlay")
    camera = importlib.import_module(f"{PACKAGE}.images.view.camera")
    matrix = camera.uv_of_picture(
        *view,
        picture_aspect=WIDTH / HEIGHT,
        image_aspect=plane.aspect,
    )

    def draw() -> None:
        if name in found:
            return
        target = gpu.types.GPUOffScreen(WIDTH, HEIGHT, format="RGBA32F")
        with target.bind():
            framebuffer = gpu.state.active_framebuffer_get()
            framebuffer.clear(color=(0, 0, 0, 0))
            overlay.draw_plane(plane, matrix, (WIDTH, HEIGHT), texels=texels, wipe=0.5)
            pixels = framebuffer.read_color(0, 0, WIDTH, HEIGHT, 4, 0, "FLOAT")
        found[name] = np.array(pixels.to_list())
        target.free()

    handle = bpy.types.SpaceImageEditor.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")
    importlib.import_module(f"{PACKAGE}.bridge.editors").redraw()
    yield from until(lambda: name in found)
    bpy.types.SpaceImageEditor.draw_handler_remove(handle, "WINDOW")


play(session())
