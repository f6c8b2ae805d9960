# SPDX-License-Identifier: GPL-3.0-or-later

"""The Prefilter tab in the sidebar of the Image and UV editors."""

import bpy

from .. import users
from ..menus import draw_bake
from ..operators.source import shown_image


class PREFILTER_PT_bake(bpy.types.Panel):
    """Settings and button of the bake."""

    bl_label = "Mipmaps"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Prefilter"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = context.scene.prefilter_bake
        settings.draw_in(self.layout)
        image = shown_image(context)
        if image is not None:
            text = users.what_is_read(context, image, settings.objects, [settings.filter])
            self.layout.label(text=text, icon="INFO")
        row = self.layout.row()
        row.scale_y = 1.5
        draw_bake(row, context)


register, unregister = bpy.utils.register_classes_factory((PREFILTER_PT_bake,))
