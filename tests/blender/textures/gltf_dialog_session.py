# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: clicks settings in the dialogs of
the glTF exporter and importer.

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
from window import (
    PACKAGE,
    begun,
    chosen_in_browser,
    clicked,
    moved,
    play,
    region,
    until,
    without_objects,
)

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
    unfold_import()
    with bpy.context.temp_override(**stage.override):
        bpy.ops.import_scene.gltf("INVOKE_DEFAULT")
    yield from pressed_in_browser("keep_levels")
    yield from until(lambda: bpy.context.scene.prefilter_gltf_import.keep_levels)
    yield from chosen_in_browser(RESULT.parent, "model.glb")
    found["images"] = sorted(image.name for image in bpy.data.images if image.size[0] == 8)
    RESULT.write_text(json.dumps(found))


class Unfolded:
    """A layout whose panel is open at first, as one that is closed shows its title alone."""

    def __init__(self, layout: bpy.types.UILayout) -> None:
        """Takes the dialog's."""
        self._layout = layout

    def panel(self, name: str, **_: bool) -> tuple[bpy.types.UILayout, bpy.types.UILayout]:
        """Returns the title and the body of the panel."""
        return self._layout.panel(name, default_closed=False)


def unfold_import() -> None:
    """Has the importer draw the panel unfolded, in whatever way it asks for that."""
    package, exporter = sys.modules[PACKAGE], sys.modules["io_scene_gltf2"]
    draw = package.draw_import
    package.draw_import = lambda context, layout: draw(context, Unfolded(layout))
    if PACKAGE in exporter.importer_extension_layout_draw:
        exporter.importer_extension_layout_draw[PACKAGE] = package.draw_import


def pressed_in_browser(name: str) -> Iterator[None]:
    """Clicks a setting near the end of the list beside the files."""
    yield from until(lambda: windows.browser() is not None)
    browser = windows.browser()
    assert browser is not None
    area = browser.screen.areas[0]
    yield from until(lambda: region(area, "TOOL_PROPS").height > 1)
    beside = region(area, "TOOL_PROPS")
    x, middle = beside.x + beside.width // 2, beside.y + beside.height // 2
    for _ in range(5):  # What the mouse is over is known some time after it is moved.
        yield from moved(browser, x, middle)
        for _ in range(20):
            browser.event_simulate(type="WHEELDOWNMOUSE", value="PRESS", x=x, y=middle)
        yield
        for y in range(beside.y + 4, beside.y + beside.height, 8):
            yield from moved(browser, x, y)
            yield
            with bpy.context.temp_override(window=browser, area=area, region=beside):
                under = bpy.context.property
            if under is not None and name in under[1]:
                yield from clicked(browser, x, y)
                return
    raise AssertionError(f"the dialog shows no setting {name}")


play(session())
