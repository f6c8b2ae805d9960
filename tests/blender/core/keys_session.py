# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: presses the default keys and one assigned to a button.

Usage: blender --factory-startup --enable-event-simulate --python keys_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Generator, Iterator
from pathlib import Path
from types import ModuleType

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
import outlines
from window import PACKAGE, Stage, begun, idle, moved, play, region, until, without_objects

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
NEW = {"ctrl": True, "shift": True}

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    without_objects()
    bodies.cube()
    yield
    found["clashes"] = clashes()
    yield from pressed_in_panels_place(stage)
    yield from assigned(stage)
    yield from changed(stage)
    yield from shown_in_preferences(stage)
    RESULT.write_text(json.dumps(found))


def clashes() -> dict[str, list[str]]:
    """Returns the entries of Blender's own keymaps at our keys, by keymap and key."""
    ours = [(one.idname, one) for keymap in keymaps("addon") for one in keymap.keymap_items]
    ours = [one for name, one in ours if name.startswith("prefilter.")]
    found["keys"] = len(ours)
    module = own_module("keys")
    places = {*module._EVERYWHERE, *(name for names in module._RIVALS.values() for name in names)}
    taken: dict[str, list[str]] = {}
    for path in bpy.utils.preset_paths("keyconfig"):
        for file in sorted(Path(path).glob("*.py")):
            bpy.utils.keyconfig_set(str(file))
            for keymap in keymaps("active"):
                for item in keymap.keymap_items if keymap.name in places else ():
                    if any(item.compare(one) for one in ours):
                        taken.setdefault(f"{file.stem}: {keymap.name}", []).append(item.idname)
    bpy.utils.keyconfig_set(str(Path(path) / "Blender.py"))
    return taken


def own_module(name: str) -> ModuleType:
    """Returns a module of the add-on."""
    return sys.modules[f"{PACKAGE}.core.{name}"]


def keymaps(which: str) -> list[bpy.types.KeyMap]:
    """Returns the keymaps of a configuration."""
    return list(getattr(bpy.context.window_manager.keyconfigs, which).keymaps)


def pressed(stage: Stage, key: str, **modifiers: bool) -> Iterator[None]:
    """Presses a key over the editor."""
    main = region(stage.area, "WINDOW")
    x, y = main.x + 200, main.y + 200
    yield from moved(stage.window, x, y)
    for value in ("PRESS", "RELEASE"):
        stage.window.event_simulate(type=key, value=value, x=x, y=y, **modifiers)
        yield


def pressed_in_panels_place(stage: Stage) -> Iterator[None]:
    """Presses the key of Voxelize, which then has the settings of the panel; and undoes that."""
    bpy.context.scene.prefilter_voxelize.depth = 4
    bpy.ops.ed.undo_push(message="before")
    yield from pressed(stage, "V", shift=True, alt=True)
    yield from until(idle)
    yield
    last = bpy.context.window_manager.operators[-1]
    found["pressed"] = [last.bl_idname, last.properties.depth]
    bpy.ops.ed.undo()
    yield


def assigned(stage: Stage) -> Iterator[None]:
    """Takes the key of Voxelize, and assigns one, in the context menu of its button."""
    x, y = yield from found_button(stage, "PREFILTER_OT_voxelize")
    # Add to Quick Favorites, Change Shortcut, Remove Shortcut: as the settings are looked up by
    # the operator, Blender finds its key.
    yield from chosen(stage, "HOME", "DOWN_ARROW", "DOWN_ARROW")
    found["removed"] = keys("voxelize")
    for key, modifiers in (("ESC", {}), ("K", NEW)):
        yield from right_clicked(stage, x, y)
        yield from chosen(stage, "END")
        yield from pressed(stage, key, **modifiers)
        found[f"assigned_{key}"] = keys("voxelize")
    bpy.context.scene.prefilter_voxelize.depth = 3
    yield from pressed(stage, "K", **NEW)
    yield from until(idle)
    yield
    last = bpy.context.window_manager.operators[-1]
    found["pressed_again"] = [last.bl_idname, last.properties.depth]
    bpy.ops.ed.undo()
    yield


def changed(stage: Stage) -> Iterator[None]:
    """Changes and takes the key of an operator whose button has settings of its own."""
    without_objects()
    outlines.text("A")
    yield from stage.redrawn()
    x, y = yield from found_button(stage, "PREFILTER_OT_rasterize")
    yield from chosen(stage, "END", "UP_ARROW")
    yield from pressed(stage, "A")
    found["changed"] = keys("rasterize")
    with bpy.context.temp_override(**stage.override):
        _, item = own_module("keys").find(bpy.context, "prefilter.rasterize")
        found["rivals"] = own_module("keys").conflicting_operators(bpy.context, item)
    yield from right_clicked(stage, x, y)
    yield from chosen(stage, "END")
    found["taken"] = keys("rasterize")


def found_button(stage: Stage, name: str) -> Generator[None, None, tuple[int, int]]:
    """Right-clicks in the sidebar until that is over the button of an operator."""
    yield from stage.open_tab()
    yield
    sidebar = region(stage.area, "UI")
    seen: list[str] = []

    def note(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
        del menu
        button = getattr(context, "button_operator", None)
        seen.append(button.bl_rna.identifier if button is not None else "")

    bpy.types.UI_MT_button_context_menu.prepend(note)
    x = sidebar.x + sidebar.width // 2 - 20
    for below_top in range(10, sidebar.height, 20):
        y = sidebar.y + sidebar.height - below_top
        yield from right_clicked(stage, x, y)
        if name in seen:
            bpy.types.UI_MT_button_context_menu.remove(note)
            return x, y
        stage.escape()
        yield
    raise AssertionError(f"the sidebar has no button of {name}")


def right_clicked(stage: Stage, x: int, y: int) -> Iterator[None]:
    """Opens the context menu of a button."""
    yield from moved(stage.window, x, y)
    for value in ("PRESS", "RELEASE"):
        stage.window.event_simulate(type="RIGHTMOUSE", value=value, x=x, y=y)
        yield
    yield


def chosen(stage: Stage, *ways: str) -> Iterator[None]:
    """Chooses the entry of a menu that keys lead to."""
    for key in (*ways, "RET"):
        for value in ("PRESS", "RELEASE"):
            stage.window.event_simulate(type=key, value=value)
            yield


def keys(operator: str) -> list[str]:
    """Returns the keys of an operator outside of Sculpt Mode."""
    return [
        item.to_string()
        for keymap in keymaps("user")
        for item in keymap.keymap_items
        if item.idname == f"prefilter.{operator}" and keymap.name != "Sculpt"
    ]


def shown_in_preferences(stage: Stage) -> Iterator[None]:
    """Draws the preferences of the add-on with its keys."""
    preferences = sys.modules[f"{PACKAGE}.preferences"].PREFILTER_AP_preferences
    draw, drawn = preferences.draw, []

    def noted(self: bpy.types.AddonPreferences, context: bpy.types.Context) -> None:
        draw(self, context)
        drawn.append(context.area.type)

    preferences.draw = noted
    stage.area.type = "PREFERENCES"
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "Prefilter"
    yield
    bpy.ops.preferences.addon_expand(module=PACKAGE)
    yield from stage.redrawn()
    preferences.draw = draw
    found["drawn"] = drawn[:1]


play(session())
