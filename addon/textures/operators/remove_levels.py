# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.remove_levels`: removes the levels of an image."""

import bpy

from ...bridge import editors
from ...core.outcome import FAILURES, reason
from ...core.properties import single_property
from ...core.translations import report
from ..choices import RemoveSettings
from .source import PictureOperator


class PREFILTER_OT_remove_levels(PictureOperator, bpy.types.Operator):
    """Removes the levels of one or all images."""

    bl_idname = "prefilter.remove_levels"
    bl_label = "Remove Levels"
    bl_description = (
        "Remove the preview and the level images of the image; in Adjust Last Operation also what "
        "was baked into the texture cache. Texture files are kept"
    )
    bl_options = {"REGISTER", "UNDO"}

    kinds: single_property(RemoveSettings, "kinds")
    use_all: single_property(RemoveSettings, "use_all")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the settings."""
        del context
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.column().prop(self, "kinds")
        layout.prop(self, "use_all")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Removes them."""
        from ...bridge import level_images
        from .. import removal

        try:
            if self.use_all:
                chosen = list(bpy.data.images)
            else:
                image = self.chosen_image(context)
                chosen = [level_images.source_of_level(image) or image]
                # The editor may show one of the levels that are removed.
                self.image = chosen[0].name
                editors.show(context, chosen[0])
            outcome = removal.remove(chosen, self.kinds)
        except FAILURES as error:
            self.report({"ERROR"}, report(reason(error)))
            return {"CANCELLED"}
        editors.redraw()
        self.report({"INFO"}, report(outcome.summary))
        return {"FINISHED"}
