# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: uses the redo panel with the mouse.

Usage: blender --factory-startup --enable-event-simulate --python redo_session.py -- RESULT.json
"""

import importlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
import scenes
from window import PACKAGE, RedoPanel, begun, clicked, play, region, until, working_on

RESULT = Path(sys.argv[sys.argv.index("--") + 1])

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    window, area = stage.window, stage.area
    core = importlib.import_module(f"{PACKAGE}.core.redo")
    for operands in ("hide", "delete"):
        yield from boolean(window, area, operands)
    yield from volume(window, area)
    quick, core.QUICK_SECONDS = core.QUICK_SECONDS, -1.0
    yield from voxelize(window, area)
    area.type = "IMAGE_EDITOR"
    yield
    yield from bake(window, area)
    core.QUICK_SECONDS = quick
    yield from click_after_esc(window, area)
    yield from esc_asks(window, area)
    RESULT.write_text(json.dumps(found))


def started(
    window: bpy.types.Window, area: bpy.types.Area, name: str, **options: object
) -> Iterator[None]:
    """Runs an operator as a menu does, and opens its redo panel."""
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(window=window, area=area, region=region(area, "WINDOW")):
        operator = getattr(bpy.ops.prefilter, name)
        assert operator("INVOKE_DEFAULT", True, **options) == {"RUNNING_MODAL"}
    yield from until(lambda: not running(window))
    yield
    if region(area, "HUD").height < 40:
        yield from RedoPanel(window, area).unfolded()


def boolean(window: bpy.types.Window, area: bpy.types.Area, operands: str) -> Iterator[None]:
    """Changes the operation."""
    yield from cleared()
    bodies.cube("Other", location=(1, 0, 0))
    bodies.cube("First")
    yield from started(window, area, "boolean", depth=5, operation="difference", operands=operands)
    told = {"volume": volume_of("First")}
    panel = RedoPanel(window, area)
    yield from panel.step("operation", up=False)
    told["operation"] = panel.operator.properties.operation
    told["volume_after"] = volume_of("First")
    bpy.ops.ed.undo()
    yield
    told["undone"] = {obj.name: vertices(obj.name) for obj in bpy.data.objects}
    found[operands] = told


def volume(window: bpy.types.Window, area: bpy.types.Area) -> Iterator[None]:
    """Changes the depth of a volume, which is selected in the place of its mesh."""
    yield from cleared()
    bodies.cube("Fog")
    path = str(RESULT.with_name("fog.vdb"))
    yield from started(window, area, "voxelize", depth=5, output="volume", filepath=path)
    panel = RedoPanel(window, area)
    found["volume"] = [panel.operator.properties.depth]
    size = Path(path).stat().st_size
    yield from panel.step("depth")
    assert Path(path).stat().st_size > 2 * size
    found["volume"].append(panel.operator.properties.depth)


def voxelize(window: bpy.types.Window, area: bpy.types.Area) -> Iterator[None]:
    """Changes the depth where all work counts as slow, applies that, and cancels a larger one."""
    yield from cleared()
    bodies.sphere("Ball", subdivisions=4)
    options = {"depth": 5, "output": "mesh", "adaptivity": 0.0}
    yield from started(window, area, "voxelize", **options)
    panel = RedoPanel(window, area)
    told = {"before": vertices("Ball")}
    yield from panel.step("depth")
    told["waits"] = vertices("Ball")
    with working_on("voxels.voxelization", "Voxelization", until_cancelled=False):
        yield from panel.apply()
        told["running"] = running(window)
        told["while_running"] = vertices("Ball")
    yield from until(lambda: not running(window))
    yield
    told["after"] = vertices("Ball")
    told["depth"] = panel.operator.properties.depth
    found["apply"] = told

    yield from panel.step("depth")
    with working_on("voxels.voxelization", "Voxelization"):
        yield from panel.apply()
        window.event_simulate(type="ESC", value="PRESS")
        yield from until(lambda: not running(window))
    yield
    found["esc"] = {
        "before": told["after"],
        "after": vertices("Ball"),
        "depth": panel.operator.properties.depth,
        "operators": [one.bl_idname for one in bpy.context.window_manager.operators],
        "staged": [str(path) for path in RESULT.parent.glob(".prefilter*")],
    }
    bpy.ops.ed.undo()
    yield
    told["undone"] = vertices("Ball")


def bake(window: bpy.types.Window, area: bpy.types.Area) -> Iterator[None]:
    """Changes the content; frames are read in steps, after Blender has restored its own data."""
    yield from cleared()
    image = scenes.image("Paint", scenes.noise(64, 64))
    scenes.textured_quad(image)
    area.spaces.active.image = image
    yield
    settings = {"levels": 4, "use_frames": True, "frame_end": 3, "content": "color"}
    yield from started(window, area, "bake_mipmaps", **settings)
    told = {"before": level()}
    panel = RedoPanel(window, area)
    yield from panel.step("content", up=False)
    told["content"] = panel.operator.properties.content
    told["waits"] = level()
    yield from panel.apply()
    yield from until(lambda: not running(window))
    yield
    told["after"] = level()
    told["frame"] = bpy.context.scene.frame_current
    found["bake"] = told


def click_after_esc(window: bpy.types.Window, area: bpy.types.Area) -> Iterator[None]:
    """Cancels a bake, and clicks on the button of its panel at once."""
    area.spaces.active.show_region_ui = True
    bpy.utils.register_class(ButtonPanel)
    sidebar = region(area, "UI")
    yield from until(lambda: sidebar.active_panel_category != "UNSUPPORTED")
    sidebar.active_panel_category = ButtonPanel.bl_category
    area.tag_redraw()
    yield
    yield
    x, y = sidebar.x + sidebar.width // 3, sidebar.y + sidebar.height - 80
    with working_on("textures.bake", "Bake"):
        yield from clicked(window, x, y)
        yield from until(lambda: running(window))
        window.event_simulate(type="ESC", value="PRESS", x=x, y=y)
        yield from until(lambda: not running(window))
    with working_on("textures.bake", "Bake"):
        yield from clicked(window, x + 1, y)
        found["click_after_esc"] = running(window)
        window.event_simulate(type="ESC", value="PRESS", x=x, y=y)
        yield from until(lambda: not running(window))


def esc_asks(window: bpy.types.Window, area: bpy.types.Area) -> Iterator[None]:
    """Presses Esc amid work that counts as long: twice, which takes the question back; then yes."""
    core = importlib.import_module(f"{PACKAGE}.core.runs")
    seconds, core.ASKING_SECONDS = core.ASKING_SECONDS, 0.0
    told = found["asks"] = []
    with working_on("textures.bake", "Bake"):
        with bpy.context.temp_override(window=window, area=area, region=region(area, "WINDOW")):
            bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT")
        yield
        for keys in (["ESC"], ["ESC"], ["ESC", "RET"]):
            for key in keys:
                window.event_simulate(type=key, value="PRESS")
                yield
                yield
            told.append(running(window))
            for _ in range(4):
                yield
        yield from until(lambda: not running(window))
    core.ASKING_SECONDS = seconds


class ButtonPanel(bpy.types.Panel):
    """One large button."""

    bl_idname = "TEST_PT_button"
    bl_label = "Button"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Button"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws it."""
        del context
        self.layout.scale_y = 5.0
        self.layout.operator("prefilter.bake_mipmaps")


def cleared() -> Iterator[None]:
    """Removes all objects, and the redo panel of the last operator."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    bpy.ops.ed.undo_push(message="cleared")
    yield


def running(window: bpy.types.Window) -> list[str]:
    """Returns the names of the operators that work."""
    return [operator.bl_idname for operator in window.modal_operators]


def vertices(name: str) -> int:
    """Returns how many vertices an object's mesh has."""
    return len(bpy.data.objects[name].data.vertices)


def volume_of(name: str) -> float:
    """Returns the volume of an object."""
    return bodies.volume(bpy.data.objects[name])


def level() -> float:
    """Returns how much the texels of a level image differ."""
    return float(scenes.pixels("Paint.mip01").std())


play(session())
