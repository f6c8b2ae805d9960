# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws the panels, resamples an image, makes a table.

One run ends well and is done again with another setting, and one is cancelled by Esc.

Usage: blender --factory-startup --enable-event-simulate --python resample_session.py -- RESULT.json
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
    panel = bpy.types.PREFILTER_PT_resample
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
        found["polls_without_image"] = bpy.ops.prefilter.resample_image.poll()
    area.spaces.active.image = scenes.image("Paint", scenes.noise(64, 96))
    sidebar = region(area, "UI")
    yield from until(lambda: sidebar.active_panel_category != "UNSUPPORTED")
    sidebar.active_panel_category = "Prefilter"
    settings = bpy.context.scene.prefilter_resample
    for name, value in (
        ("warp", "corners"),
        ("lower_left", (2.0, 2.0)),  # Refused, which the panel says.
        ("warp", "rectify"),
        ("size", "pixels"),
        ("method", "table"),
        ("method", "exact"),
        ("filter", "gaussian"),
    ):
        setattr(settings, name, value)
        area.tag_redraw()
        yield
        yield
    found["tab"] = sidebar.active_panel_category

    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**override):
        found["started"] = list(
            bpy.ops.prefilter.resample_image("INVOKE_DEFAULT", True, scale_x=0.5, scale_y=0.5)
        )
        found["refused_while_running"] = refused(bpy.ops.prefilter.resample_image)
    yield from until(idle)
    yield
    found["shown"] = area.spaces.active.image.name
    found["size"] = list(area.spaces.active.image.size)
    if region(area, "HUD").height < 40:
        yield from RedoPanel(window, area).unfolded()
    yield from RedoPanel(window, area).step("scale_x")
    found["size_after_redo"] = list(area.spaces.active.image.size)
    found["after_redo"] = names()
    bpy.ops.ed.undo()
    yield
    found["undone"] = names()

    area.spaces.active.image = scenes.image("Big", scenes.noise(1024, 1024))
    with bpy.context.temp_override(**override):
        bpy.ops.prefilter.resample_image(
            "INVOKE_DEFAULT", scale_x=4.0, scale_y=4.0, filter="lanczos3"
        )
    found["works"] = not idle()
    window.event_simulate(type="ESC", value="PRESS")
    yield from until(idle)
    found["cancelled"] = names()

    area.type = "TEXT_EDITOR"
    area.spaces.active.show_region_ui = True
    yield
    sidebar = region(area, "UI")
    yield from until(lambda: sidebar.active_panel_category != "UNSUPPORTED")
    sidebar.active_panel_category = "Prefilter"
    yield
    yield
    with bpy.context.temp_override(
        window=window, area=area, region=region(area, "WINDOW"), space_data=area.spaces.active
    ):
        bpy.ops.prefilter.sampling_table("INVOKE_DEFAULT", filter="tent", texels=4)
    yield from until(idle)
    yield
    found["text"] = area.spaces.active.text.name
    with bpy.context.temp_override(window=window, area=area, region=region(area, "WINDOW")):
        bpy.ops.prefilter.sampling_table("INVOKE_DEFAULT", texels=9, grid=16, slices=8)
    found["table_works"] = not idle()
    window.event_simulate(type="ESC", value="PRESS")
    yield from until(idle)
    found["texts"] = [text.name for text in bpy.data.texts]
    RESULT.write_text(json.dumps(found))


def names() -> list[str]:
    """Returns the names of the images that are no views."""
    return sorted(image.name for image in bpy.data.images if image.source != "VIEWER")


play(session())
