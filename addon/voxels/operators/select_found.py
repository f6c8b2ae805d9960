# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.select_found`: selects a report's faces or edges in the sources of a result."""

import bpy
from bpy.props import IntProperty

from ...core.translations import report, tr
from ...core.wording import Sentence


class PREFILTER_OT_select_found(bpy.types.Operator):
    """Selects faces or edges of the report."""

    bl_idname = "prefilter.select_found"
    bl_label = "Select Reported Places"
    bl_description = (
        "Show the source of the object in its stead, and select these faces or edges there in Edit "
        "Mode"
    )
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    index: IntProperty(
        name="Row", description="Row of the report, from the top", min=0, options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is a report on the active object or on its result."""
        from ..memory import updatable_result

        result = updatable_result(context.active_object)
        if context.mode not in {"OBJECT", "EDIT_MESH"}:
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        if result is None or not len(result.prefilter_found.places):
            cls.poll_message_set(tr("The active object has no reported places"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Selects them."""
        from ..memory import updatable_result
        from ..places import select

        result = updatable_result(context.active_object)
        assert result is not None
        if self.index >= len(result.prefilter_found.places):
            self.report({"ERROR"}, report("The report has no such row"))
            return {"CANCELLED"}
        try:
            source = select(result, self.index, context)
        except ValueError as error:
            self.report({"ERROR"}, report(error.args[0]))
            return {"CANCELLED"}
        self.report({"INFO"}, report(Sentence("Selected in '{}'", source.name)))
        return {"FINISHED"}
