# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws levels in an Image editor, and keeps what it shows.

Usage: blender --factory-startup --enable-event-simulate --python preview_session.py -- RESULT.npz
"""

import importlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import addon_utils
import bpy
import gpu
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import scenes
from window import play, until

PACKAGE = "bl_ext.user_default.prefilter"
RESULT = sys.argv[sys.argv.index("--") + 1]
CHANNELS = ("COLOR_ALPHA", "COLOR", "ALPHA", "GREEN")
SIDE = 48  # Of an offscreen picture.

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    assert addon_utils.enable(PACKAGE, default_set=True) is not None
    preview = importlib.import_module(f"{PACKAGE}.mipmaps.view.preview")
    bright = scenes.noise(64, 64, seed=2)
    bright[..., :3] *= 1.5
    images = {
        "byte": scenes.image("Byte", scenes.noise(32, 64)),
        "float": scenes.image("Float", bright, is_float=True),
        "alpha": scenes.image("Alpha", scenes.noise(16, 16, alpha=True, seed=3)),
        "data": scenes.image("Data", scenes.noise(16, 16, seed=4), colorspace="Non-Color"),
    }
    for name, image in images.items():
        scenes.textured_quad(image, name)
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "IMAGE_EDITOR"
    area.spaces.active.image = images["byte"]
    yield

    region = next(region for region in area.regions if region.type == "WINDOW")
    override = {"window": window, "area": area, "region": region}
    settings = bpy.context.window_manager.prefilter_view
    bpy.context.scene.prefilter_bake.wrap = "clamp"

    def shoot(name: str) -> Iterator[None]:
        area.tag_redraw()
        yield
        yield
        seen = scenes.screen(os.environ["FRAMEBUFFER"])
        bottom, left = region.y, region.x
        found[f"{name}.screen"] = seen[bottom : bottom + region.height, left : left + region.width]
        low = region.view2d.region_to_view(0.5, 0.5)
        high = region.view2d.region_to_view(region.width - 0.5, region.height - 0.5)
        found[f"{name}.u"] = np.linspace(low[0], high[0], region.width)
        found[f"{name}.v"] = np.linspace(low[1], high[1], region.height)

    for name, image in images.items():
        area.spaces.active.image = image
        with bpy.context.temp_override(**override):
            bpy.ops.image.view_all(fit_view=True)
        for channels in CHANNELS:
            area.spaces.active.display_channels = channels
            yield from shoot(f"{name}.plain.{channels}")
        area.spaces.active.display_channels = "COLOR_ALPHA"
        with bpy.context.temp_override(**override):
            started = bpy.ops.prefilter.preview_levels("INVOKE_DEFAULT", compare="tent")
        assert started == {"RUNNING_MODAL"}, started
        yield from until(lambda image=image: preview.find(image) is not None)
        settings.mip_value, settings.use_wipe = 0.0, False
        for channels in CHANNELS:
            area.spaces.active.display_channels = channels
            yield from shoot(f"{name}.level0.{channels}")
        area.spaces.active.display_channels = "COLOR_ALPHA"
        settings.mip_value = 2.0
        yield from shoot(f"{name}.level2")

    shown = preview.find(images["byte"])
    area.spaces.active.image = images["byte"]
    settings.compare, settings.use_wipe, settings.wipe = "tent", True, 0.5
    yield from shoot("byte.wipe")
    settings.use_wipe, settings.mip_value = False, 1.5
    found["byte.last_level"] = shown.last_level
    with bpy.context.temp_override(**override):
        bpy.ops.image.view_zoom_ratio(ratio=5.0)
    yield from shoot("byte.zoomed")

    settings.use_preview = False
    yield from shoot("byte.off")
    settings.use_preview = True

    yield from offscreen(preview, images["byte"], "offscreen")
    bpy.context.scene.prefilter_bake.reader = "srgb-after"
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.preview_levels("EXEC_DEFAULT", compare="tent")
    yield from offscreen(preview, images["byte"], "encoded")
    bpy.context.scene.prefilter_bake.reader = "linear"
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.preview_levels("EXEC_DEFAULT", compare="tent")

    for obj in bpy.data.objects:
        obj.select_set(False)
    inner = [(0.3 + 0.4 * u, 0.3 + 0.4 * v) for u, v in scenes.UNIT_SQUARE]
    edited = scenes.quads("Inner", [inner])
    edited.data.materials.append(bpy.data.materials["byte material"])
    with bpy.context.temp_override(**override):
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
    area.ui_type = "UV"
    area.spaces.active.image = images["byte"]
    with bpy.context.temp_override(**override):
        bpy.ops.image.view_all(fit_view=True)
    yield from shoot("byte.uv")
    with bpy.context.temp_override(**override):
        bpy.ops.object.mode_set(mode="OBJECT")
    area.ui_type = "IMAGE_EDITOR"
    area.spaces.active.image = images["byte"]
    yield

    with bpy.context.temp_override(**override):
        bpy.ops.ed.undo_push(message="before")
        bpy.data.objects["byte"].location.x += 1
        bpy.ops.ed.undo_push(message="after")
    yield
    image = bpy.data.images["Byte"]
    found["stale after a move"] = preview.find(image).is_stale
    preview.find(image).is_stale = False
    with bpy.context.temp_override(**override):
        bpy.ops.ed.undo()
    yield
    image = bpy.data.images["Byte"]
    found["editor's image after undo"] = str(getattr(area.spaces.active.image, "name", None))
    area.spaces.active.image = image
    found["kept after undo"] = preview.find(image) is not None
    yield from shoot("byte.undone")
    preview.find(image).is_stale = False
    found["stale before painting"] = preview.find(image).is_stale
    image.pixels.foreach_set(scenes.noise(32, 64, seed=9).ravel())
    image.update()
    image.update_tag()
    yield
    found["stale after painting"] = preview.find(image).is_stale

    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.end_preview()
    found["ended"] = preview.find(image) is None
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    found["kept in next file"] = len(preview._previews)
    addon_utils.disable(PACKAGE, default_set=True)
    yield
    # Blender removes the package of a disabled extension, and other tests need it.
    assert addon_utils.enable(PACKAGE, default_set=True) is not None
    np.savez(RESULT, **found)


def offscreen(preview: object, image: bpy.types.Image, name: str) -> Iterator[None]:
    """Draws levels where nothing is rounded to bytes."""
    overlay = importlib.import_module(f"{PACKAGE}.mipmaps.view.overlay")
    shown = preview.find(image)
    # Two units of UV space, so that the wrap modes show.
    view = Matrix(((1.0, 0, 0, -0.5), (0, 1.0, 0, -0.5), (0, 0, 1, 0), (0, 0, 0, 1)))

    def draw() -> None:
        if f"{name} 0" in found:
            return
        target = gpu.types.GPUOffScreen(SIDE, SIDE, format="RGBA32F")
        for index, mip_value in enumerate((0.0, 1.0, 1.25, 99.0)):
            with target.bind():
                gpu.state.active_framebuffer_get().clear(color=(0, 0, 0, 0), depth=1.0)
                overlay.draw_levels(
                    shown,
                    view,
                    filters=("tent", "pam-bilinear"),
                    mip_value=mip_value,
                    wipe=0.5,
                )
                pixels = gpu.state.active_framebuffer_get().read_color(
                    0, 0, SIDE, SIDE, 4, 0, "FLOAT"
                )
            found[f"{name} {index}"] = np.array(pixels.to_list())
        target.free()

    handle = bpy.types.SpaceImageEditor.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")
    importlib.import_module(f"{PACKAGE}.bridge.editors").redraw()
    yield from until(lambda: f"{name} 3" in found)
    bpy.types.SpaceImageEditor.draw_handler_remove(handle, "WINDOW")


play(session())
