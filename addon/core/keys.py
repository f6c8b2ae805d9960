# SPDX-License-Identifier: GPL-3.0-or-later

"""The keys that operators have at first, and those that users give them.

A key is pressed without settings: the operator has those of its panel.
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
"""Where other operators have keys that are pressed in the same place."""
_EVERYWHERE = ("Frames", "Screen", "Screen Editing", WINDOW)


class Key(NamedTuple):
    """A key that an operator has at first, together with Shift and Alt.

    Attributes:
        operator: The operator, without the prefix `prefilter.`.
        letter: The key.
        keymap: Where it is pressed: "Object Mode", "Sculpt", or "Image", an Image editor.
    """

    operator: str
    letter: str
    keymap: str


class Keys:
    """The keys at first: each subject says those of its own.

    A subject may have `KEYS`, a sequence of `Key`.
    """

    def __init__(self, subjects: Sequence[ModuleType]) -> None:
        """Takes the packages of the subjects."""
        self._keys: list[Key] = [key for one in subjects for key in getattr(one, "KEYS", ())]
        self._made: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []

    def register(self) -> None:
        """Makes the keys known to Blender, which has none without a window."""
        known = bpy.context.window_manager.keyconfigs.addon
        for key in self._keys if known is not None else ():
            keymap = known.keymaps.new(key.keymap, space_type=_SPACES.get(key.keymap, "EMPTY"))
            name = f"{OPERATORS}{key.operator}"
            made = keymap.keymap_items.new(name, key.letter, "PRESS", shift=True, alt=True)
            self._made.append((keymap, made))

    def unregister(self) -> None:
        """Takes them back."""
        for keymap, made in self._made:
            keymap.keymap_items.remove(made)
        self._made.clear()


def every(context: bpy.types.Context) -> Iterator[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]]:
    """Yields what users have for the operators of the add-on, with the keymaps that have them."""
    for keymap in context.window_manager.keyconfigs.user.keymaps:
        for item in keymap.keymap_items:
            if item.idname.startswith(OPERATORS):
                yield keymap, item


def find(
    context: bpy.types.Context, operator: str
) -> tuple[bpy.types.KeyMap, bpy.types.KeyMapItem] | None:
    """Returns the key of an operator in the editor; None if it has none."""
    for name in dict.fromkeys((keymap_name(context), WINDOW)):
        keymap = _keymap(context, name)
        for item in keymap.keymap_items if keymap is not None else ():
            if item.idname == operator and item.active:
                return keymap, item
    return None


def keymap_name(context: bpy.types.Context) -> str:
    """Returns the name of the keymap for operators of the editor."""
    if context.area is None:
        return WINDOW
    if context.area.type == "VIEW_3D" and context.mode == "SCULPT":
        return _SCULPT
    return _EDITORS.get(context.area.type, WINDOW)


def assign(
    context: bpy.types.Context, operator: str, event: bpy.types.Event, settings: dict[str, Any]
) -> bpy.types.KeyMapItem:
    """Gives an operator the key of an event, in place of the one that it has.

    Args:
        context: Has the editor in which the key is pressed.
        operator: The operator.
        event: The press.
        settings: Properties that the operator gets.
    """
    pressed = {name: int(getattr(event, name)) for name in _MODIFIERS}
    found = find(context, operator)
    if found is None:
        name = keymap_name(context)
        item = _items(context, name).new(operator, event.type, "PRESS", **pressed)
        for key, value in settings.items():
            setattr(item.properties, key, value)
        number = item.id
        context.window_manager.keyconfigs.update()
        item = _items(context, name).from_id(number)
    else:
        _, item = found
        item.type = event.type
        for name, value in pressed.items():
            setattr(item, name, value)
    context.preferences.is_dirty = True
    return item


def remove(context: bpy.types.Context, operator: str) -> bool:
    """Takes the key of an operator; returns whether it had one."""
    found = find(context, operator)
    if found is None:
        return False
    keymap, item = found
    keymap.keymap_items.remove(item)
    context.preferences.is_dirty = True
    return True


def rivals(context: bpy.types.Context, item: bpy.types.KeyMapItem) -> list[str]:
    """Returns the names of what else has the key of an item in the editor."""
    found: dict[str, None] = {}
    for name in (*_RIVALS[keymap_name(context)], *_EVERYWHERE):
        keymap = _keymap(context, name)
        for other in keymap.keymap_items if keymap is not None else ():
            if other.active and other.idname != item.idname and item.compare(other):
                found[other.name] = None
    return list(found)


def _keymap(context: bpy.types.Context, name: str) -> bpy.types.KeyMap | None:
    return context.window_manager.keyconfigs.user.keymaps.get(name)


def _items(context: bpy.types.Context, name: str) -> bpy.types.KeyMapItems:
    keymap = _keymap(context, name)
    if keymap is None:
        raise ValueError(f"Blender has no keymap '{name}'")
    return keymap.keymap_items
