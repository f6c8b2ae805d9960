# SPDX-License-Identifier: GPL-3.0-or-later

"""Default shortcuts of operators, and the shortcuts that users assign.

A shortcut stores no settings: the operator uses those of its panel.
"""

from collections.abc import Iterator, Sequence
from types import ModuleType
from typing import Any, NamedTuple

import bpy

OPERATORS = "prefilter."
WINDOW = "Window"
_EDITORS = {"VIEW_3D": "Object Mode", "IMAGE_EDITOR": "Image"}
_SCULPT = "Sculpt"
_SPACES = {"Image": "IMAGE_EDITOR"}
_MODIFIERS = ("ctrl", "shift", "alt", "oskey")
_RIVALS = {
    "Object Mode": ("Object Mode", "Object Non-modal", "3D View Generic", "3D View"),
    _SCULPT: (_SCULPT, "3D View Generic", "3D View"),
    "Image": ("Image", "Image Generic", "UV Editor"),
    WINDOW: (WINDOW,),
}
"""For each keymap, the keymaps that are active in the same editor."""
_EVERYWHERE = ("Frames", "Screen", "Screen Editing", WINDOW)


class Key(NamedTuple):
    """A default shortcut: a key with Shift and Alt.

    Attributes:
        operator: The operator, without the prefix `prefilter.`.
        letter: The key.
        keymap: The keymap: "Object Mode", "Sculpt", or "Image" for the Image editor.
    """

    operator: str
    letter: str
    keymap: str


class Keys:
    """The default shortcuts of all subjects: their optional `KEYS`, sequences of `Key`."""

    def __init__(self, subjects: Sequence[ModuleType]) -> None:
        """Collects the shortcuts from the packages of the subjects."""
        self._keys: list[Key] = [
            key for subject in subjects for key in getattr(subject, "KEYS", ())
        ]
        self._items: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []

    def register(self) -> None:
        """Adds the keymap items; without a window Blender has no keymaps."""
        config = bpy.context.window_manager.keyconfigs.addon
        for key in self._keys if config is not None else ():
            keymap = config.keymaps.new(key.keymap, space_type=_SPACES.get(key.keymap, "EMPTY"))
            name = f"{OPERATORS}{key.operator}"
            item = keymap.keymap_items.new(name, key.letter, "PRESS", shift=True, alt=True)
            self._items.append((keymap, item))

    def unregister(self) -> None:
        """Removes them."""
        for keymap, item in self._items:
            keymap.keymap_items.remove(item)
        self._items.clear()


def addon_items(
    context: bpy.types.Context,
) -> Iterator[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]]:
    """Yields the user's keymap items for the add-on's operators, with their keymaps."""
    for keymap in context.window_manager.keyconfigs.user.keymaps:
        for item in keymap.keymap_items:
            if item.idname.startswith(OPERATORS):
                yield keymap, item


def find(
    context: bpy.types.Context, operator: str
) -> tuple[bpy.types.KeyMap, bpy.types.KeyMapItem] | None:
    """Returns the keymap item of an operator in the editor; None if there is none."""
    for name in dict.fromkeys((keymap_name(context), WINDOW)):
        keymap = _keymap(context, name)
        for item in keymap.keymap_items if keymap is not None else ():
            if item.idname == operator and item.active:
                return keymap, item
    return None


def keymap_name(context: bpy.types.Context) -> str:
    """Returns the name of the editor's keymap."""
    if context.area is None:
        return WINDOW
    if context.area.type == "VIEW_3D" and context.mode == "SCULPT":
        return _SCULPT
    return _EDITORS.get(context.area.type, WINDOW)


def assign(
    context: bpy.types.Context, operator: str, event: bpy.types.Event, settings: dict[str, Any]
) -> bpy.types.KeyMapItem:
    """Assigns the key of an event to an operator, replacing its present one.

    Args:
        context: The context with the editor.
        operator: The operator.
        event: The press of the key.
        settings: Properties of the operator.
    """
    modifiers = {name: int(getattr(event, name)) for name in _MODIFIERS}
    present = find(context, operator)
    if present is None:
        name = keymap_name(context)
        item = _items(context, name).new(operator, event.type, "PRESS", **modifiers)
        for key, value in settings.items():
            setattr(item.properties, key, value)
        number = item.id
        context.window_manager.keyconfigs.update()
        item = _items(context, name).from_id(number)
    else:
        _, item = present
        item.type = event.type
        for name, value in modifiers.items():
            setattr(item, name, value)
    context.preferences.is_dirty = True
    return item


def remove(context: bpy.types.Context, operator: str) -> bool:
    """Removes the shortcut of an operator; returns whether it had one."""
    present = find(context, operator)
    if present is None:
        return False
    keymap, item = present
    keymap.keymap_items.remove(item)
    context.preferences.is_dirty = True
    return True


def conflicting_operators(context: bpy.types.Context, item: bpy.types.KeyMapItem) -> list[str]:
    """Returns the names of other operators with the same key in the editor."""
    names: dict[str, None] = {}
    for name in (*_RIVALS[keymap_name(context)], *_EVERYWHERE):
        keymap = _keymap(context, name)
        for other in keymap.keymap_items if keymap is not None else ():
            if other.active and other.idname != item.idname and item.compare(other):
                names[other.name] = None
    return list(names)


def _keymap(context: bpy.types.Context, name: str) -> bpy.types.KeyMap | None:
    return context.window_manager.keyconfigs.user.keymaps.get(name)


def _items(context: bpy.types.Context, name: str) -> bpy.types.KeyMapItems:
    keymap = _keymap(context, name)
    if keymap is None:
        raise ValueError(f"Blender has no keymap '{name}'")
    return keymap.keymap_items
