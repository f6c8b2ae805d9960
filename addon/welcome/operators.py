# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.demonstrate`, `prefilter.end_demonstration` and `prefilter.dismiss_welcome`."""

from typing import Any

import bpy
from bpy.props import EnumProperty

from ..core.choices import items
from ..core.preferences import PACKAGE
from ..core.translations import CONTEXT, reported, tr
from .choices import DEMONSTRATIONS, is_demonstration


class PREFILTER_OT_demonstrate(bpy.types.Operator):
    """Starts a demonstration in a separate scene."""

    bl_idname = "prefilter.demonstrate"
    bl_label = "Demonstrate"
    bl_description = "Show what Prefilter does, in a scene of its own"
    bl_options = frozenset({"UNDO", "INTERNAL"})

    kind: EnumProperty(
        name="Demonstration",
        description="What to show",
        items=items(DEMONSTRATIONS),
        translation_context=CONTEXT,
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """Returns the tooltip of a button."""
        del context
        shown = tr(DEMONSTRATIONS[properties.kind].description)
        return f"{shown}. {tr('It runs in a scene of its own; yours stays as it is')}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the window can show another scene."""
        if context.mode != "OBJECT":
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        if context.window is None:
            cls.poll_message_set(tr("It needs a window"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Starts the demonstration."""
        from . import demonstrations

        try:
            demonstrations.begin(context, self.kind)
        except RuntimeError as error:
            self.report({"ERROR"}, reported(error))
        return {"FINISHED"}


class PREFILTER_OT_end_demonstration(bpy.types.Operator):
    """Removes the scene of a demonstration."""

    bl_idname = "prefilter.end_demonstration"
    bl_label = "Back to My Scene"
    bl_description = "Remove the scene of the demonstration with all that is in it, and show yours"
    bl_options = frozenset({"UNDO", "INTERNAL"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether a demonstration is shown."""
        if context.window is None or not is_demonstration(context.scene):
            cls.poll_message_set(tr("This is no scene of a demonstration"))
            return False
        if len(bpy.data.scenes) == 1:
            cls.poll_message_set(tr("There is no other scene"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Removes it."""
        from . import demonstrations

        demonstrations.end(context)
        return {"FINISHED"}


class PREFILTER_OT_dismiss_welcome(bpy.types.Operator):
    """Hides the welcome, and sets this in the preferences."""

    bl_idname = "prefilter.dismiss_welcome"
    bl_label = "Dismiss"
    bl_description = "Do not show the welcome again; the preferences of Prefilter bring it back"
    bl_options = frozenset({"INTERNAL"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Sets the preference."""
        addon = context.preferences.addons.get(PACKAGE)
        if addon is None:
            return {"CANCELLED"}
        addon.preferences.show_welcome = False
        # Makes Blender save the preferences when it quits, if auto-save is on.
        context.preferences.is_dirty = True
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory(
    (PREFILTER_OT_demonstrate, PREFILTER_OT_end_demonstration, PREFILTER_OT_dismiss_welcome)
)
