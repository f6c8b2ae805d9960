# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: draws levels over a quad in the 3D view, and drags the wipe.

Usage: blender --factory-startup --enable-event-simulate --python model_view_session.py -- RESULT
"""

import importlib
import json
import sys
from collections.abc import Generator, Iterator
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import scenes
from window import PACKAGE, Stage, begun, idle, moved, picture, play, region, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
SIDE = 64

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    without_objects()
    pixels = scenes.noise(SIDE, SIDE)
    pixels[: SIDE // 2, :, :3] = 0.0
    image = scenes.image("Paint", pixels)
    # The surface shows the upper half of the image alone.
    quad = scenes.quads("Quad", [[(u, 0.5 + v / 2) for u, v in scenes.UNIT_SQUARE]])
    quad.data.materials.append(scenes.material("Paint material", image))
    bpy.context.view_layer.objects.active = quad
    bpy.context.scene.prefilter_bake.wrap = "clamp"
    with bpy.context.temp_override(**stage.override):
        bpy.ops.view3d.view_axis(type="TOP")
        bpy.ops.view3d.view_selected()
    stage.area.spaces.active.shading.type = "SOLID"
    yield from until(lambda: not stage.area.spaces.active.region_3d.is_perspective)
    for _ in range(10):
        yield
    before = data()
    found["plain"] = yield from sides(stage)
    with bpy.context.temp_override(**stage.override):
        started = bpy.ops.prefilter.preview_on_model("INVOKE_DEFAULT", compare="box")
    found["started"] = list(started)
    yield from until(idle)
    yield from shown(stage)
    yield from dragged(stage)
    found["data is the same"] = data() == before
    yield from ended(stage)
    RESULT.write_text(json.dumps(found))


def shown(stage: Stage) -> Iterator[None]:
    """Shows the coarsest levels, and the levels of a distance."""
    view = settings()
    view.use_wipe, view.compare, view.choice, view.mip_value = True, "box", "level", 6.0
    yield from stage.redrawn()
    found["coarsest"] = yield from sides(stage)
    for kind in ("MATERIAL", "SOLID"):
        stage.area.spaces.active.shading.type = kind
        for overlays in (True, False):
            stage.area.spaces.active.overlay.show_overlays = overlays
            for _ in range(5 if kind == "MATERIAL" else 2):
                yield from stage.redrawn()
            found[f"{kind} {overlays}"] = yield from sides(stage)
    view.choice, view.distance = "distance", 1024.0
    yield from stage.redrawn()
    found["far"] = yield from sides(stage)
    view.distance = 1.0
    yield from stage.redrawn()
    found["near"] = yield from sides(stage)
    view.use_model = False
    yield from stage.redrawn()
    found["switched off"] = yield from sides(stage)
    view.use_model, view.choice = True, "level"
    found["levels"] = {
        name: [float(one) for one in made[-1][0, 0, :3]]
        for name, made in module("preview").find(bpy.data.images["Paint"]).levels.items()
    }
    quad = bpy.data.objects["Quad"]
    quad.hide_set(True)
    yield from stage.redrawn()
    found["hidden"] = yield from sides(stage)
    quad.hide_set(False)
    yield from stage.redrawn()


def dragged(stage: Stage) -> Iterator[None]:
    """Drags the line of the wipe."""
    stage.area.spaces.active.show_gizmo = True
    yield from stage.redrawn()
    part, window = region(stage.area, "WINDOW"), stage.window
    x, y = part.x + part.width // 2, part.y + part.height // 3
    yield from moved(window, x - 90, y)
    yield from moved(window, x, y)
    window.event_simulate(type="LEFTMOUSE", value="PRESS", x=x, y=y)
    yield
    for step in (40, 80):
        window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x + step, y=y)
        yield
    window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=x + 80, y=y)
    yield
    found["dragged by"] = (settings().wipe - 0.5) * part.width


def ended(stage: Stage) -> Iterator[None]:
    """Ends it, after an undo, which leaves it."""
    with bpy.context.temp_override(**stage.override):
        bpy.ops.ed.undo_push(message="before")
        bpy.data.objects["Quad"].location.z = 1
        bpy.ops.ed.undo_push(message="after")
        bpy.ops.ed.undo()
    yield from stage.redrawn()
    settings().wipe = 0.5
    yield from stage.redrawn()
    found["after undo"] = yield from sides(stage)
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.end_model_preview()
    yield from stage.redrawn()
    found["ended"] = yield from sides(stage)
    found["kept"] = module("on_model").current() is not None


def settings() -> bpy.types.PropertyGroup:
    """Returns the settings of the view."""
    return bpy.context.window_manager.prefilter_view


def module(name: str) -> object:
    """Returns a module of the add-on."""
    return importlib.import_module(f"{PACKAGE}.textures.view.{name}")


def data() -> list[list[str]]:
    """Returns the names of the file's data-blocks."""
    kinds = (bpy.data.images, bpy.data.materials, bpy.data.meshes, bpy.data.objects)
    nodes = [node.name for node in bpy.data.materials["Paint material"].node_tree.nodes]
    return [*([one.name for one in kind] for kind in kinds), nodes]


def sides(stage: Stage) -> Generator[None, None, list[list[float]]]:
    """Returns the mean color left and right of the middle of the view, below the line's arrows."""
    shown = yield from picture(stage.area)
    x, y = shown.shape[1] // 2, shown.shape[0] // 2 - 40
    boxes = (shown[y - 15 : y + 15, x - 35 : x - 5], shown[y - 15 : y + 15, x + 5 : x + 35])
    return [np.mean(box, axis=(0, 1)).tolist() for box in boxes]


play(session())
