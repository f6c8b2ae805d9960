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

import addon_utils
import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import outlines
import window as windows
from window import RedoPanel, idle, play, refused, region, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="8" height="8"><path d="M0 0H8V8Z"/></svg>'
windows.SECONDS_PER_STEP = 0.05


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    assert addon_utils.enable("bl_ext.user_default.prefilter", default_set=True) is not None
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    outlines.text("Hello")
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    override = {"window": window, "area": area, "region": region(area, "WINDOW")}
    area.spaces.active.show_region_ui = True
    sidebar = region(area, "UI")
    yield from until(lambda: sidebar.active_panel_category != "UNSUPPORTED")
    sidebar.active_panel_category = "Prefilter"
    area.tag_redraw()
    yield
    yield
    found = {"tab": sidebar.active_panel_category}
    with bpy.context.temp_override(**override):
        bpy.ops.wm.call_menu(name="PREFILTER_MT_object")
    yield
    window.event_simulate(type="ESC", value="PRESS")
    yield

    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**override):
        found["started"] = list(
            bpy.ops.prefilter.rasterize("INVOKE_DEFAULT", True, width=64, height=64)
        )
        found["refused_while_running"] = refused(bpy.ops.prefilter.rasterize)
    yield from until(idle)
    yield
    found["made"] = sizes()
    if region(area, "HUD").height < 40:
        yield from RedoPanel(window, area).unfolded()
    panel = RedoPanel(window, area)
    yield from panel.step("filter")
    found["redone"] = (panel.operator.properties.filter, *filters())
    with bpy.context.temp_override(**override):
        found["started_again"] = list(bpy.ops.prefilter.update_drawn("INVOKE_DEFAULT"))
    yield from until(idle)
    found["updated"] = filters()
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    yield
    found["undone"] = sizes()

    # Without a graphics card so many letters take long to draw.
    bpy.data.objects["Text"].display_type = "BOUNDS"
    bpy.data.objects["Text"].data.body = "Hamburgefonts " * 100
    yield
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.rasterize(
            "INVOKE_DEFAULT", width=4096, height=4096, filter="radial3", pixel_type="float"
        )
    found["works"] = not idle()
    window.event_simulate(type="ESC", value="PRESS")
    yield from until(idle)
    found["cancelled"] = sizes()

    path = RESULT.with_name("drawing.svg")
    path.write_text(SVG)
    area.type = "IMAGE_EDITOR"
    yield
    override["region"] = region(area, "WINDOW")
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.rasterize_svg("INVOKE_DEFAULT", filepath=str(path), width=32, height=32)
    yield from until(idle)
    yield
    found["svg"] = sizes()
    found["shown"] = area.spaces.active.image.name
    region(area, "UI")
    area.spaces.active.show_region_ui = True
    yield
    region(area, "UI").active_panel_category = "Prefilter"
    area.tag_redraw()
    yield
    yield
    for name in ("PREFILTER_MT_image", "IMAGE_MT_uvs"):
        with bpy.context.temp_override(**override):
            bpy.ops.wm.call_menu(name=name)
        yield
        window.event_simulate(type="ESC", value="PRESS")
        yield
    RESULT.write_text(json.dumps(found))


def sizes() -> dict[str, tuple[int, int]]:
    """Returns the sizes of the images that were made."""
    images = [image for image in bpy.data.images if image.prefilter_drawn.is_drawn]
    return {image.name: tuple(image.size) for image in images}


def filters() -> list[str]:
    """Returns the filters that the images were made with."""
    return [image.prefilter_drawn.filter for image in bpy.data.images if image.name in sizes()]


play(session())
