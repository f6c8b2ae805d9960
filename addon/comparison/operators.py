# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.switch_source` and `prefilter.forget_source`: the source of a result."""

import bpy

from ..core.translations import report, tr
from ..core.wording import listed


class _ResultOperator:
    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the active object is a result or a source."""
        from ..bridge.kept_sources import result_of

        if context.mode != "OBJECT":
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        if result_of(context.active_object) is None:
            cls.poll_message_set(tr("The active object has no stored sources"))
            return False
        return True


class PREFILTER_OT_switch_source(_ResultOperator, bpy.types.Operator):
    """Shows the source instead of the result, or the result again."""

    bl_idname = "prefilter.switch_source"
    bl_label = "Show Source or Result"
    bl_description = (
        "Show the source of the active object in its place, or the result again. Both stay as "
        "they are"
    )
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Switches between the two."""
        from ..bridge.kept_sources import result_of, show

        result = result_of(context.active_object)
        assert result is not None
        is_source = not result.prefilter_made_of.is_source_shown
        shown = listed(obj.name for obj in show(result, context, source=is_source))
        text = report("Shows the source, {}") if is_source else report("Shows the result, {}")
        self.report({"INFO"}, text.format(shown))
        return {"FINISHED"}


class PREFILTER_OT_forget_source(_ResultOperator, bpy.types.Operator):
    """Deletes the stored source of a result."""

    bl_idname = "prefilter.forget_source"
    bl_label = "Forget Source"
    bl_description = (
        "Keep only the result: the copy of the original object is removed, which makes the "
        "file smaller. Points and curves stay where they are"
    )
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Deletes it."""
        from ..bridge.kept_sources import forget, result_of

        result = result_of(context.active_object)
        assert result is not None
        forget(result, context)
        self.report({"INFO"}, report("'{}' has no source any more").format(result.name))
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory(
    (PREFILTER_OT_switch_source, PREFILTER_OT_forget_source)
)
