# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.remove_levels`: what bakes have made of an image goes again."""

import bpy
from bpy.props import StringProperty

from ...bridge import editors
from ...core.outcome import FAILURES
from ...core.properties import single_property
from ..choices import RemoveSettings
from .source import image_to_read, shown_image


class PREFILTER_OT_remove_levels(bpy.types.Operator):
    """Removes the levels of an image, or of all."""

    bl_idname = "prefilter.remove_levels"
    bl_label = "Remove Levels"
    bl_description = (
        "Remove the preview and the level images of the image; in Adjust Last Operation also what "
        "was baked into the texture cache. Texture files are kept"
    )
    bl_options = {"REGISTER", "UNDO"}

    image: StringProperty(
        name="Image",
        description="The image whose levels go; the image of the editor if empty",
        options={"SKIP_SAVE"},
    )
    kinds: single_property(RemoveSettings, "kinds")
    use_all: single_property(RemoveSettings, "use_all")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an image."""
        is_editor = context.area is not None and context.area.type == "IMAGE_EDITOR"
        if is_editor and shown_image(context) is None:
            cls.poll_message_set("Open an image in this editor first")
            return False
        if not bpy.data.images:
            cls.poll_message_set("There is no image in this file")
            return False
        return True

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
                image = image_to_read(context, self.image)
                chosen = [level_images.source_of_level(image) or image]
                # Its levels go, and with them perhaps what the editor shows.
                self.image = chosen[0].name
                editors.show(context, chosen[0])
            outcome = removal.remove(chosen, self.kinds)
        except FAILURES as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        editors.redraw()
        self.report({"INFO"}, outcome.summary)
        return {"FINISHED"}
