# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws the panels, resamples an image, makes a table.

One run ends well and is done again with another setting, and one is cancelled by Esc.

Usage: blender --factory-startup --enable-event-simulate --python resample_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import scenes
from window import RedoPanel, Stage, begun, held, idle, play, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])


found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun("IMAGE_EDITOR", opened="PREFILTER_PT_resample")
    yield
    with bpy.context.temp_override(**stage.override):
        found["polls_without_image"] = bpy.ops.prefilter.resample_image.poll()
    stage.area.spaces.active.image = scenes.image("Paint", scenes.noise(64, 96))
    yield from panel(stage)
    yield from resampled(stage)
    yield from table(stage)
    RESULT.write_text(json.dumps(found))


def panel(stage: Stage) -> Iterator[None]:
    """Draws the panel with several settings."""
    yield from stage.open_tab()
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
        yield from stage.redrawn()
    found["tab"] = stage.tab


def resampled(stage: Stage) -> Iterator[None]:
    """Resamples an image, does so again with another scale, undoes it; cancels another run."""
    space = stage.area.spaces.active
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(**stage.override):
        found["started"] = list(
            bpy.ops.prefilter.resample_image("INVOKE_DEFAULT", True, scale_x=0.5, scale_y=0.5)
        )
    yield from until(idle)
    yield
    found["shown"] = space.image.name
    found["size"] = list(space.image.size)
    yield from stage.redo_panel()
    yield from RedoPanel(stage.window, stage.area).step("scale_x")
    found["size_after_redo"] = list(space.image.size)
    found["after_redo"] = names()
    bpy.ops.ed.undo()
    yield
    found["undone"] = names()

    space.image = bpy.data.images["Paint"]
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.resample_image("INVOKE_DEFAULT", scale_x=4.0, scale_y=4.0)
        found["works"] = not idle()
        stage.escape()
        yield from until(idle)
    found["cancelled"] = names()


def table(stage: Stage) -> Iterator[None]:
    """Makes a sampling table in the Text editor, and cancels another."""
    area = stage.area
    area.type = "TEXT_EDITOR"
    area.spaces.active.show_region_ui = True
    yield
    yield from stage.open_tab()
    with bpy.context.temp_override(**stage.override, space_data=area.spaces.active):
        bpy.ops.prefilter.sampling_table("INVOKE_DEFAULT", filter="tent", texels=4)
    yield from until(idle)
    yield
    found["text"] = area.spaces.active.text.name
    with held():
        with bpy.context.temp_override(**stage.override):
            bpy.ops.prefilter.sampling_table("INVOKE_DEFAULT", filter="tent", texels=4)
        found["table_works"] = not idle()
        stage.escape()
        yield from until(idle)
    found["texts"] = [text.name for text in bpy.data.texts]


def names() -> list[str]:
    """Returns the names of the images that are no views."""
    return sorted(image.name for image in bpy.data.images if image.source != "VIEWER")


play(session())
