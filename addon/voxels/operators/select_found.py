# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.select_found`: places of a report, selected in what a result was made of."""

import bpy
from bpy.props import IntProperty

from ...core.translations import report, tr
from ...core.wording import Sentence


class PREFILTER_OT_select_found(bpy.types.Operator):
    """Selects places of the report."""

    bl_idname = "prefilter.select_found"
    bl_label = "Select Reported Places"
    bl_description = (
        "Show what the object was made of in its place, and select these faces or edges there in "
        "Edit Mode"
    )
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    index: IntProperty(
        name="Row", description="Row of the report, from the top", min=0, options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the active object has a report, or is what one is about."""
        from ..memory import made_of

        result = made_of(context.active_object)
        if context.mode not in {"OBJECT", "EDIT_MESH"}:
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        if result is None or not len(result.prefilter_found.places):
            cls.poll_message_set(tr("The active object has no reported places"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Selects them."""
        from ..memory import made_of
        from ..places import select

        result = made_of(context.active_object)
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
