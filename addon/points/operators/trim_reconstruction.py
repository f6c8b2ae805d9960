# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.trim_reconstruction`: trims a reconstructed surface where points are far away."""

import bpy

from ...core.outcome import FAILURES
from ...core.translations import report, tr
from ...core.wording import Sentence
from ..properties import TrimProperties


class PREFILTER_OT_trim_reconstruction(TrimProperties, bpy.types.Operator):
    """Trims the active object's surface where points are far away."""

    bl_idname = "prefilter.trim_reconstruction"
    bl_label = "Trim Reconstruction"
    bl_description = (
        "Cut the active reconstructed surface where it is far from all points, without "
        "reconstructing it again"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the active object has the attributes for trimming."""
        from ..trimming import may_be_trimmed

        if context.mode != "OBJECT":
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        if not may_be_trimmed(context.active_object):
            cls.poll_message_set(
                tr("Select a reconstructed surface, with its attributes 'distance' and 'density'")
            )
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Cuts the surface."""
        from ..trimming import trim

        obj = context.active_object
        try:
            cut = trim(obj, self.to_settings())
        except FAILURES as error:
            self.report({"ERROR"}, report(error.args[0]))
            return {"CANCELLED"}
        share = f"{100.0 * cut:.2g} %"
        self.report({"INFO"}, report(Sentence("Cut {} of '{}'", share, obj.name)))
        return {"FINISHED"}
