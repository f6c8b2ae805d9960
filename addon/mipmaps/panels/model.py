# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of all images, in the Prefilter tab of the 3D view's sidebar."""

import bpy

from ...bridge.meshes import may_show_image
from ...core.sidebar import OptionsPanel, SidebarPanel
from ..choices import CONTENTS
from ..menus import draw_bake_model
from ..model import known

_ICONS = {
    "color": "IMAGE_RGB",
    "cutout": "IMAGE_RGB_ALPHA",
    "data": "IMAGE_ALPHA",
    "normal": "NORMALS_FACE",
}
_MOST_IMAGES = 12


class PREFILTER_PT_model(SidebarPanel, bpy.types.Panel):
    """What is set most often, what there is to bake, and the button."""

    bl_label = "Mipmaps of All Images"
    bl_options = frozenset({"DEFAULT_CLOSED"})
    fits = staticmethod(may_show_image)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = context.scene.prefilter_model
        settings.draw_in(self.layout)
        if settings.folder.startswith("//") and not bpy.data.is_saved:
            self.layout.label(text="Save the .blend file first", icon="ERROR")
        found = known.images(context, settings.objects) or []
        column = self.layout.column(align=True)
        for one in found[:_MOST_IMAGES]:
            row = column.row()
            row.label(text=one.image, icon=_ICONS[one.content])
            row.label(text="Roughness" if one.partner else CONTENTS[one.content].label)
        if len(found) > _MOST_IMAGES:
            column.label(text=f"and {len(found) - _MOST_IMAGES} more", icon="BLANK1")
        row = self.layout.row()
        row.scale_y = 1.5
        draw_bake_model(row, context)


class PREFILTER_PT_model_options(SidebarPanel, OptionsPanel, bpy.types.Panel):
    """The other settings of the bake of all images."""

    bl_parent_id = PREFILTER_PT_model.__name__
    fits = staticmethod(may_show_image)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        context.scene.prefilter_model.draw_others(self.layout)


register, unregister = bpy.utils.register_classes_factory(
    (PREFILTER_PT_model, PREFILTER_PT_model_options)
)
