# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: sets what the dialogs of the glTF exporter and importer show.

Usage: blender --factory-startup --enable-event-simulate --python gltf_dialog_session.py
    -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import scenes
import window as windows
from gltf_trees import read_tree
from window import begun, chosen_in_browser, clicked, moved, play, region, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    without_objects()
    cube = scenes.cube(scenes.image("Paint", scenes.noise(16, 16)))
    tree = cube.active_material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(texture.outputs[0], shader.inputs["Base Color"])
    with bpy.context.temp_override(**stage.override):
        bpy.ops.export_scene.gltf("INVOKE_DEFAULT")
    yield from pressed_in_browser("use_mipmaps")
    yield from until(lambda: bpy.context.scene.prefilter_gltf.use_mipmaps)
    yield from chosen_in_browser(RESULT.parent, "model.glb")
    path = RESULT.with_name("model.glb")
    yield from until(path.exists)
    found["extensions"] = read_tree(path)["extensionsUsed"]
    without_objects()
    with bpy.context.temp_override(**stage.override):
        bpy.ops.import_scene.gltf("INVOKE_DEFAULT")
    yield from pressed_in_browser("keep_levels", unfolds=True)
    yield from until(lambda: bpy.context.scene.prefilter_gltf_import.keep_levels)
    yield from chosen_in_browser(RESULT.parent, "model.glb")
    found["images"] = sorted(image.name for image in bpy.data.images if image.size[0] == 8)
    RESULT.write_text(json.dumps(found))


def pressed_in_browser(name: str, *, unfolds: bool = False) -> Iterator[None]:
    """Clicks a setting at the end of those beside the files, in a panel if that unfolds."""
    yield from until(lambda: windows.browser() is not None)
    browser = windows.browser()
    assert browser is not None
    area = browser.screen.areas[0]
    yield from until(lambda: region(area, "TOOL_PROPS").height > 1)
    yield
    beside = region(area, "TOOL_PROPS")
    x, bottom = beside.x + beside.width // 2, beside.y + 4
    for above in range(0, beside.height, 8):
        if unfolds:
            yield from clicked(browser, beside.x + 40, bottom + above)
        yield from scrolled_down(browser, x, beside.y + beside.height // 2)
        places = [bottom + above]
        if unfolds:  # It is below its title, or at the end where it was out of sight.
            below = range(bottom + above, max(bottom, bottom + above - 64), -8)
            places = [*below, *range(bottom, bottom + 64, 8)]
        for y in places:
            yield from moved(browser, x, y)
            with bpy.context.temp_override(window=browser, area=area, region=beside):
                under = bpy.context.property
            if under is not None and name in under[1]:
                yield from clicked(browser, x, y)
                return
    raise AssertionError(f"the dialog shows no setting {name}")


def scrolled_down(browser: bpy.types.Window, x: int, y: int) -> Iterator[None]:
    """Turns the wheel until the end is in sight."""
    yield from moved(browser, x, y)
    for _ in range(8):
        browser.event_simulate(type="WHEELDOWNMOUSE", value="PRESS", x=x, y=y)
    yield


play(session())
