"""The Prefilter tab in the sidebar of the Image and UV editors, and the Image menu."""

import bpy

from ...core.properties import copy
from .. import users
from ..choices import Settings
from ..operators.bake_mipmaps import PREFILTER_OT_bake_mipmaps
from ..operators.source import shown_image

_ICON = "TEXTURE"


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
        _draw_operator(row, settings)


def register() -> None:
    """Registers the panel and the menu entry."""
    bpy.utils.register_class(PREFILTER_PT_bake)
    bpy.types.IMAGE_MT_image.append(_draw_image_menu)


def unregister() -> None:
    """Removes them."""
    bpy.types.IMAGE_MT_image.remove(_draw_image_menu)
    bpy.utils.unregister_class(PREFILTER_PT_bake)


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_operator(menu.layout, context.scene.prefilter_bake)


def _draw_operator(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    operator = layout.operator(PREFILTER_OT_bake_mipmaps.bl_idname, icon=_ICON)
    copy(settings, operator, Settings)
