# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws panels and menus, and rasterizes through the operators.

One run ends well, is done again with another filter, and undone; one is cancelled by Esc; an image
is updated; and one is of an SVG file that the file browser names.

Usage: blender --factory-startup --enable-event-simulate --python shape_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import outlines
from window import RedoPanel, Stage, begun, held, idle, play, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="8" height="8"><path d="M0 0H8V8Z"/></svg>'


found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    without_objects()
    outlines.text("Hello")
    yield from stage.open_tab()
    found["tab"] = stage.tab
    yield from stage.menus("PREFILTER_MT_object")
    yield from rasterized(stage)
    yield from cancelled(stage)
    yield from decal(stage)
    yield from svg(stage)
    RESULT.write_text(json.dumps(found))


def rasterized(stage: Stage) -> Iterator[None]:
    """Rasterizes a text, does so again with another filter, updates it, and undoes all that."""
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**stage.override):
        found["started"] = list(
            bpy.ops.prefilter.rasterize("INVOKE_DEFAULT", True, width=64, height=64)
        )
    yield from until(idle)
    yield
    found["made"] = sizes()
    yield from stage.redo_panel()
    panel = RedoPanel(stage.window, stage.area)
    yield from panel.step("filter")
    found["redone"] = (panel.operator.properties.filter, *filters())
    with bpy.context.temp_override(**stage.override):
        found["started_again"] = list(bpy.ops.prefilter.update_drawn("INVOKE_DEFAULT"))
    yield from until(idle)
    found["updated"] = filters()
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    yield
    found["undone"] = sizes()


def cancelled(stage: Stage) -> Iterator[None]:
    """Cancels a run."""
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.rasterize("INVOKE_DEFAULT", width=32, height=32)
        found["works"] = not idle()
        stage.escape()
        yield from until(idle)
    found["cancelled"] = sizes()


def decal(stage: Stage) -> Iterator[None]:
    """Rasterizes beside an Image editor, puts the image on a plane, and undoes that."""
    areas = [area for area in stage.window.screen.areas if area != stage.area]
    editor = max(areas, key=lambda area: area.width * area.height)
    kind, editor.type = editor.type, "IMAGE_EDITOR"
    yield
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.rasterize("INVOKE_DEFAULT", True, side=128, resolution="side")
    yield from until(idle)
    yield
    image = editor.spaces.active.image
    found["shown beside"] = (image.name, image.size[0], image.size[1] < 80)
    yield from stage.redrawn()
    text = bpy.data.objects["Text"]
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.use_as_decal("INVOKE_DEFAULT", True)
    yield
    shading = stage.area.spaces.active.shading
    found["decal"] = (bpy.context.active_object.name, text.visible_get(), shading.color_type)
    yield from stage.redo_panel()
    yield from RedoPanel(stage.window, stage.area).step("offset")
    found["offset"] = bpy.context.active_object.location.z > 0
    bpy.ops.ed.undo()
    yield
    found["decal undone"] = [obj.name for obj in bpy.data.objects if obj.visible_get()]
    bpy.ops.ed.undo()
    yield
    editor.type = kind
    yield


def svg(stage: Stage) -> Iterator[None]:
    """Rasterizes a file in the Image editor, and draws the panels on shapes."""
    area = stage.area
    path = RESULT.with_name("drawing.svg")
    path.write_text(SVG)
    area.type = "IMAGE_EDITOR"
    yield
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.rasterize_svg("INVOKE_DEFAULT", filepath=str(path), width=32, height=32)
    yield from until(idle)
    yield
    found["svg"] = sizes()
    found["shown"] = area.spaces.active.image.name
    yield from dropped(stage, path)
    yield from stage.open_tab()
    yield from stage.menus("PREFILTER_MT_image", "IMAGE_MT_uvs")


def dropped(stage: Stage, path: Path) -> Iterator[None]:
    """Simulates the drop of a file: Blender passes the file, and no settings."""
    handler = bpy.types.PREFILTER_FH_svg
    settings = bpy.context.scene.prefilter_rasterize
    settings.resolution, settings.width, settings.height = "size", 48, 40
    with bpy.context.temp_override(**stage.override):
        found["takes_drop"] = handler.poll_drop(bpy.context)
        getattr(bpy.ops.prefilter, handler.bl_import_operator.partition(".")[2])(
            "INVOKE_DEFAULT", filepath=str(path)
        )
    yield from until(idle)
    yield
    found["dropped"] = list(stage.area.spaces.active.image.size)


def sizes() -> dict[str, tuple[int, int]]:
    """Returns the sizes of the images that were made."""
    images = [image for image in bpy.data.images if image.prefilter_drawn.is_drawn]
    return {image.name: tuple(image.size) for image in images}


def filters() -> list[str]:
    """Returns the filters that the images were made with."""
    return [image.prefilter_drawn.filter for image in bpy.data.images if image.name in sizes()]


play(session())
