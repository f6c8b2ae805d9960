# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws the panel and the menu, and resizes an image.

One run ends well and is done again with another size, and one is cancelled by Esc.

Usage: blender --factory-startup --enable-event-simulate --python resize_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import addon_utils
import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import scenes
import window as windows
from window import RedoPanel, idle, play, refused, region, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
windows.SECONDS_PER_STEP = 0.05


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    assert addon_utils.enable("bl_ext.user_default.prefilter", default_set=True) is not None
    # A panel that is closed is not drawn.
    panel = bpy.types.PREFILTER_PT_resize
    bpy.utils.unregister_class(panel)
    panel.bl_options = set()
    bpy.utils.register_class(panel)
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "IMAGE_EDITOR"
    area.spaces.active.show_region_ui = True
    yield
    override = {"window": window, "area": area, "region": region(area, "WINDOW")}
    found = {}
    with bpy.context.temp_override(**override):
        found["polls_without_image"] = bpy.ops.prefilter.resize_image.poll()
    area.spaces.active.image = scenes.image("Paint", scenes.noise(64, 96))
    sidebar = region(area, "UI")
    yield from until(lambda: sidebar.active_panel_category != "UNSUPPORTED")
    sidebar.active_panel_category = "Prefilter"
    for size in ("percent", "pixels"):
        bpy.context.scene.prefilter_resize.size = size
        area.tag_redraw()
        yield
        yield
    found["tab"] = sidebar.active_panel_category
    with bpy.context.temp_override(**override):
        bpy.ops.wm.call_menu(name="PREFILTER_MT_image")
    yield
    window.event_simulate(type="ESC", value="PRESS")
    yield

    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**override):
        found["started"] = list(
            bpy.ops.prefilter.resize_image(
                "INVOKE_DEFAULT", True, size="pixels", width=32, filter="box"
            )
        )
        found["refused_while_running"] = refused(bpy.ops.prefilter.resize_image)
    yield from until(idle)
    yield
    found["shown"] = area.spaces.active.image.name
    if region(area, "HUD").height < 40:
        yield from RedoPanel(window, area).unfolded()
    yield from RedoPanel(window, area).step("filter")
    found["filter"] = RedoPanel(window, area).operator.properties.filter
    found["after_redo"] = names()
    found["shown_after_redo"] = area.spaces.active.image.name
    bpy.ops.ed.undo()
    yield
    found["undone"] = names()

    area.spaces.active.image = scenes.image("Big", scenes.noise(1024, 1024))
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.resize_image("INVOKE_DEFAULT", percent=390, filter="radial3")
    found["works"] = not idle()
    window.event_simulate(type="ESC", value="PRESS")
    yield from until(idle)
    found["cancelled"] = names()
    RESULT.write_text(json.dumps(found))


def names() -> list[str]:
    """Returns the names of the images that are no views."""
    return sorted(image.name for image in bpy.data.images if image.source != "VIEWER")


play(session())
