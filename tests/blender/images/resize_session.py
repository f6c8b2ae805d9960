# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws the panel and the menu, and resizes an image.

One run ends well and is done again with another size, and one is cancelled by Esc.

Usage: blender --factory-startup --enable-event-simulate --python resize_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import scenes
from window import RedoPanel, begun, held, idle, play, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun("IMAGE_EDITOR", opened="PREFILTER_PT_resize")
    space = stage.area.spaces.active
    yield
    found = {}
    with bpy.context.temp_override(**stage.override):
        found["polls_without_image"] = bpy.ops.prefilter.resize_image.poll()
    space.image = scenes.image("Paint", scenes.noise(64, 96))
    yield from stage.open_tab()
    for size in ("percent", "pixels"):
        bpy.context.scene.prefilter_resize.size = size
        yield from stage.redrawn()
    found["tab"] = stage.tab
    yield from stage.menus("PREFILTER_MT_image")

    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**stage.override):
        found["started"] = list(
            bpy.ops.prefilter.resize_image(
                "INVOKE_DEFAULT", True, size="pixels", width=32, filter="box"
            )
        )
    yield from until(idle)
    yield
    found["shown"] = space.image.name
    yield from stage.redo_panel()
    panel = RedoPanel(stage.window, stage.area)
    yield from panel.step("filter")
    found["filter"] = panel.operator.properties.filter
    found["after_redo"] = names()
    found["shown_after_redo"] = space.image.name
    bpy.ops.ed.undo()
    yield
    found["undone"] = names()

    space.image = bpy.data.images["Paint"]
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.resize_image("INVOKE_DEFAULT", percent=390)
        found["works"] = not idle()
        stage.escape()
        yield from until(idle)
    found["cancelled"] = names()
    RESULT.write_text(json.dumps(found))


def names() -> list[str]:
    """Returns the names of the images that are no views."""
    return sorted(image.name for image in bpy.data.images if image.source != "VIEWER")


play(session())
