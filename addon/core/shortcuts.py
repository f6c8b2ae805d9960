# SPDX-License-Identifier: GPL-3.0-or-later

"""Assign Shortcut in the context menu of buttons, and the keymap in the preferences.

Blender's own entry of this name works only for operators with Blender's prefixes, such as
`object.`, from which it guesses the keymap.
"""

import json
import re
from typing import Any

import bpy
from bpy.props import StringProperty

from . import keys
from .registration import classes, entry, registration
from .translations import report, tr

_KEY = re.compile(r"[A-Z]|F\d+|NUMPAD_\w+")
_MORE_KEYS = frozenset(
    {
        *("ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE"),
        *("SPACE", "TAB", "RET", "BACK_SPACE", "DEL", "INSERT", "HOME", "END", "PAGE_UP"),
        *("PAGE_DOWN", "LEFT_ARROW", "RIGHT_ARROW", "UP_ARROW", "DOWN_ARROW", "PAUSE", "APP"),
        *("SEMI_COLON", "PERIOD", "COMMA", "QUOTE", "ACCENT_GRAVE", "MINUS", "PLUS", "SLASH"),
        *("BACK_SLASH", "EQUAL", "LEFT_BRACKET", "RIGHT_BRACKET", "GRLESS"),
    }
)
_KEYMAP_CONTEXT = bpy.app.translations.contexts.id_windowmanager
"""The translation context of keymap names."""
_ENDS = frozenset({"ESC", "LEFTMOUSE", "RIGHTMOUSE"})


class _ShortcutOperator:
    """A mixin for operators that change the shortcut of another operator."""

    bl_options = frozenset({"INTERNAL"})

    operator: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @property
    def label(self) -> str:
        """The label of the other operator."""
        name = self.operator.removeprefix(keys.OPERATORS)
        return tr(getattr(bpy.ops.prefilter, name).get_rna_type().name)


class PREFILTER_OT_assign_shortcut(_ShortcutOperator, bpy.types.Operator):
    """Waits for a key, and assigns it to an operator."""

    bl_idname = "prefilter.assign_shortcut"
    bl_label = "Assign Shortcut"
    bl_description = (
        "Press a key, with Ctrl, Shift or Alt, that does the same as this button, with the "
        "settings that its panel then has"
    )

    settings: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Starts waiting for a key."""
        del event
        text = tr("Press a key for {operator}, with Ctrl, Shift or Alt. Esc: Cancel")
        context.workspace.status_text_set(text.format(operator=self.label))
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does nothing: a script has no key to press."""
        del context
        return {"CANCELLED"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Assigns the key when one is pressed."""
        if event.value != "PRESS":
            return {"RUNNING_MODAL"}
        if event.type in _ENDS:
            context.workspace.status_text_set(None)
            return {"CANCELLED"}
        if not (_KEY.fullmatch(event.type) or event.type in _MORE_KEYS):
            return {"RUNNING_MODAL"}
        context.workspace.status_text_set(None)
        item = keys.assign(context, self.operator, event, json.loads(self.settings or "{}"))
        key = item.to_string()
        self.report({"INFO"}, f"{key}: {self.label}")
        others = keys.conflicting_operators(context, item)
        if others:
            text = report("{key} is also the key of {operator}, which may go first")
            self.report({"WARNING"}, text.format(key=key, operator=others[0]))
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Clears the status bar, for example when another file is loaded."""
        if context.workspace is not None:
            context.workspace.status_text_set(None)


class PREFILTER_OT_remove_shortcut(_ShortcutOperator, bpy.types.Operator):
    """Removes the shortcut of an operator."""

    bl_idname = "prefilter.remove_shortcut"
    bl_label = "Remove Shortcut"
    bl_description = "Take the key of this button"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Removes it."""
        if not keys.remove(context, self.operator):
            return {"CANCELLED"}
        text = report("{operator} has no key any more")
        self.report({"INFO"}, text.format(operator=self.label))
        return {"FINISHED"}


def draw_keys(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws the keymap items of all operators, for editing."""
    import rna_keymap_ui

    body = layout.column()
    body.use_property_split = False
    body.label(text="Keymap")
    config = context.window_manager.keyconfigs.user
    previous = None
    for keymap, item in keys.addon_items(context):
        if keymap != previous:
            body.label(text=keymap.name, text_ctxt=_KEYMAP_CONTEXT)
        previous = keymap
        column = body.column()
        column.context_pointer_set("keymap", keymap)
        rna_keymap_ui.draw_kmi([], config, keymap, item, column, 0)
    body.label(text="The context menu of any button has Assign Shortcut", icon="INFO")


def _draw_entries(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    pressed = getattr(context, "button_operator", None)
    owner: Any = getattr(bpy.types, pressed.bl_rna.identifier, None) if pressed else None
    name = getattr(owner, "bl_idname", "")
    if not name.startswith(keys.OPERATORS) or "INTERNAL" in owner.bl_options:
        return
    shortcut = keys.find(context, name)
    if shortcut is not None and _is_found_by_blender(pressed, shortcut[1]):
        return
    layout = menu.layout
    layout.separator()
    layout.operator_context = "INVOKE_DEFAULT"
    text = tr("Assign Shortcut")
    if shortcut is not None:
        text = tr("Change Shortcut: {key}").format(key=shortcut[1].to_string())
    assign = layout.operator(
        PREFILTER_OT_assign_shortcut.bl_idname, text=text, translate=False, icon="HAND"
    )
    assign.operator = name
    assign.settings = json.dumps(_shortcut_properties(pressed, owner))
    if shortcut is not None:
        remove = layout.operator(PREFILTER_OT_remove_shortcut.bl_idname, icon="BLANK1")
        remove.operator = name


def _is_found_by_blender(pressed: bpy.types.OperatorProperties, item: bpy.types.KeyMapItem) -> bool:
    """Returns whether Blender offers to change the shortcut itself: if the properties are equal."""
    names = set(pressed.keys())
    if not names or item.properties is None:
        return not names
    return names == set(item.properties.keys()) and all(
        getattr(pressed, name) == getattr(item.properties, name) for name in names
    )


def _shortcut_properties(pressed: bpy.types.OperatorProperties, owner: type) -> dict[str, Any]:
    """Returns the properties of a button that its shortcut stores: choices that no panel has."""
    kind = getattr(owner, "presets", None)
    settings = {name for name, _, _ in kind.options()} if kind is not None else set()
    stored = {}
    for name in set(pressed.keys()) - settings:
        declared = pressed.bl_rna.properties.get(name)
        if declared is None or declared.is_skip_save:
            continue
        is_choice = declared.type == "ENUM" and not declared.is_enum_flag
        if is_choice or (declared.type == "BOOLEAN" and not declared.is_array):
            stored[name] = getattr(pressed, name)
    return stored


register, unregister = registration(
    classes(PREFILTER_OT_assign_shortcut, PREFILTER_OT_remove_shortcut),
    entry(bpy.types.UI_MT_button_context_menu, _draw_entries),
)
