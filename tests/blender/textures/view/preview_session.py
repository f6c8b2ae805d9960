# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws levels in an Image editor, and saves the pixels.

Usage: blender --factory-startup --enable-event-simulate --python preview_session.py -- RESULT.npz
"""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import addon_utils
import bpy
import gpu
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import scenes
from window import PACKAGE, Stage, begun, picture, play, region, until

RESULT = sys.argv[sys.argv.index("--") + 1]
CHANNELS = {
    "byte": ("COLOR_ALPHA", "GREEN"),
    "float": ("COLOR_ALPHA", "COLOR"),
    "alpha": ("COLOR_ALPHA", "COLOR", "ALPHA", "GREEN"),
    "data": ("COLOR_ALPHA",),
}
SIDE = 48  # Of an offscreen picture.

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun("IMAGE_EDITOR")
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
    stage.area.spaces.active.image = images["byte"]
    yield
    bpy.context.scene.prefilter_bake.wrap = "clamp"
    for name, image in images.items():
        yield from levels(stage, name, image)
    yield from settings(stage, images["byte"])
    yield from readers(stage, images["byte"])
    yield from captions(stage)
    yield from in_uv_editor(stage, images["byte"])
    yield from changes(stage)
    yield from ends(stage)
    np.savez(RESULT, **found)


def module() -> ModuleType:
    """Returns the module of the add-on that keeps previews."""
    return importlib.import_module(f"{PACKAGE}.textures.view.preview")


def state() -> bpy.types.PropertyGroup:
    """Returns the settings of the view."""
    return bpy.context.window_manager.prefilter_view


def shoot(stage: Stage, name: str) -> Iterator[None]:
    """Saves the pixels of the screen, and their position in the image."""
    found[f"{name}.screen"] = yield from picture(stage.area)
    inside = region(stage.area, "WINDOW")
    low = inside.view2d.region_to_view(0.5, 0.5)
    high = inside.view2d.region_to_view(inside.width - 0.5, inside.height - 0.5)
    found[f"{name}.u"] = np.linspace(low[0], high[0], inside.width)
    found[f"{name}.v"] = np.linspace(low[1], high[1], inside.height)


def levels(stage: Stage, name: str, image: bpy.types.Image) -> Iterator[None]:
    """Shows an image as it is, and its levels in its place."""
    space = stage.area.spaces.active
    space.image = image
    with bpy.context.temp_override(**stage.override):
        bpy.ops.image.view_all(fit_view=True)
    for channels in CHANNELS[name]:
        space.display_channels = channels
        yield from shoot(stage, f"{name}.plain.{channels}")
    space.display_channels = "COLOR_ALPHA"
    with bpy.context.temp_override(**stage.override):
        started = bpy.ops.prefilter.preview_levels("INVOKE_DEFAULT", compare="tent")
    assert started == {"RUNNING_MODAL"}, started
    yield from until(lambda: module().find(image) is not None)
    state().mip_value, state().use_wipe = 0.0, False
    for channels in CHANNELS[name]:
        space.display_channels = channels
        yield from shoot(stage, f"{name}.level0.{channels}")
    space.display_channels = "COLOR_ALPHA"
    state().mip_value = 2.0
    yield from shoot(stage, f"{name}.level2")


def settings(stage: Stage, image: bpy.types.Image) -> Iterator[None]:
    """Shows the wipe, a level between two, from near, and no level."""
    stage.area.spaces.active.image = image
    state().compare, state().use_wipe, state().wipe = "tent", True, 0.5
    yield from shoot(stage, "byte.wipe")
    state().use_wipe, state().mip_value = False, 1.5
    found["byte.last_level"] = module().find(image).last_level
    with bpy.context.temp_override(**stage.override):
        bpy.ops.image.view_zoom_ratio(ratio=5.0)
    yield from shoot(stage, "byte.zoomed")
    state().use_preview = False
    yield from shoot(stage, "byte.off")
    state().use_preview = True


def readers(stage: Stage, image: bpy.types.Image) -> Iterator[None]:
    """Draws the levels of both readers."""
    yield from offscreen(module(), image, "offscreen")
    bpy.context.scene.prefilter_bake.reader = "srgb-after"
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.preview_levels("EXEC_DEFAULT", compare="tent")
    yield from offscreen(module(), image, "encoded")
    bpy.context.scene.prefilter_bake.reader = "linear"
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.preview_levels("EXEC_DEFAULT", compare="tent")


def captions(stage: Stage) -> Iterator[None]:
    """Shows the wipe over white, which covers the whole editor."""
    white = scenes.image("White", np.ones((8, 8, 4), np.float32))
    scenes.textured_quad(white, "white")
    stage.area.spaces.active.image = white
    # Panels' data on a scene may be a moment old.
    yield from until(lambda: _may_preview(stage))
    with bpy.context.temp_override(**stage.override):
        bpy.ops.image.view_all(fit_view=True)
        bpy.ops.prefilter.preview_levels("EXEC_DEFAULT", compare="tent")
        bpy.ops.image.view_zoom_ratio(ratio=200.0)
    state().use_wipe = True
    yield from shoot(stage, "white")
    state().use_wipe = False


def _may_preview(stage: Stage) -> bool:
    with bpy.context.temp_override(**stage.override):
        return bool(bpy.ops.prefilter.preview_levels.poll())


def in_uv_editor(stage: Stage, image: bpy.types.Image) -> Iterator[None]:
    """Shows the level below the UV map of a mesh in Edit Mode."""
    for obj in bpy.data.objects:
        obj.select_set(False)
    inner = [(0.3 + 0.4 * u, 0.3 + 0.4 * v) for u, v in scenes.UNIT_SQUARE]
    edited = scenes.quads("Inner", [inner])
    edited.data.materials.append(bpy.data.materials["byte material"])
    with bpy.context.temp_override(**stage.override):
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
    stage.area.ui_type = "UV"
    stage.area.spaces.active.image = image
    with bpy.context.temp_override(**stage.override):
        bpy.ops.image.view_all(fit_view=True)
    yield from shoot(stage, "byte.uv")
    with bpy.context.temp_override(**stage.override):
        bpy.ops.object.mode_set(mode="OBJECT")
    stage.area.ui_type = "IMAGE_EDITOR"
    stage.area.spaces.active.image = image
    yield


def changes(stage: Stage) -> Iterator[None]:
    """Moves an object, undoes that, and paints on the image."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.ed.undo_push(message="before")
        bpy.data.objects["byte"].location.x += 1
        bpy.ops.ed.undo_push(message="after")
    yield
    image = bpy.data.images["Byte"]
    found["stale after a move"] = module().find(image).is_stale
    module().find(image).is_stale = False
    with bpy.context.temp_override(**stage.override):
        bpy.ops.ed.undo()
    yield
    image, space = bpy.data.images["Byte"], stage.area.spaces.active
    found["editor's image after undo"] = str(getattr(space.image, "name", None))
    space.image = image
    found["kept after undo"] = module().find(image) is not None
    yield from shoot(stage, "byte.undone")
    module().find(image).is_stale = False
    found["stale before painting"] = module().find(image).is_stale
    image.pixels.foreach_set(scenes.noise(32, 64, seed=9).ravel())
    image.update()
    image.update_tag()
    yield
    found["stale after painting"] = module().find(image).is_stale


def ends(stage: Stage) -> Iterator[None]:
    """Ends the preview; loads another file, and disables the add-on."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.end_preview()
    preview = module()
    found["ended"] = preview.find(bpy.data.images["Byte"]) is None
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    found["kept in next file"] = len(preview._previews)
    addon_utils.disable(PACKAGE, default_set=True)
    yield
    # Blender removes the package of a disabled extension, and other tests need it.
    assert addon_utils.enable(PACKAGE, default_set=True) is not None


def offscreen(preview: object, image: bpy.types.Image, name: str) -> Iterator[None]:
    """Draws levels where nothing is rounded to bytes."""
    overlay = importlib.import_module(f"{PACKAGE}.textures.view.overlay")
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
