# SPDX-License-Identifier: GPL-3.0-or-later

"""The preview plane: a panel in the Image editor's sidebar, and entries in Image > Prefilter."""

import bpy

from ...core.menus import PREFILTER_MT_image
from ...core.registration import classes, entry, registration
from ...core.sidebar import ImagePanel, button
from ..operators.preview_plane import PREFILTER_OT_end_plane, PREFILTER_OT_preview_plane
from ..view import plane


class PREFILTER_PT_plane(ImagePanel, bpy.types.Panel):
    """The buttons, and the settings of the plane."""

    bl_label = "Preview Plane"
    bl_parent_id = "PREFILTER_PT_resample"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        plane.VIEW.draw_switch(self.layout, context)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.window_manager.prefilter_plane
        shown = plane.find(context.space_data.image)
        place = button(layout, context, PREFILTER_OT_preview_plane)
        if place:
            row = place.row(align=True)
            _draw_preview(row, context, "Preview Plane" if shown is None else "Refresh")
            if shown is not None:
                row.operator(PREFILTER_OT_end_plane.bl_idname, text="", icon="X")
        if shown is not None:
            column = layout.column()
            column.active = settings.use_plane
            column.prop(settings, "texels")
            column.prop(settings, "tilt")
            column.prop(settings, "rotation")
            column.prop(settings, "tiles")
            column.prop(settings, "wipe", slider=True)
            if shown.is_stale:
                layout.label(text="The image has changed", icon="ERROR")
            elif shown.filter != settings.filter:
                layout.label(text="The filter has changed", icon="ERROR")
        layout.prop(settings, "filter")


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_preview(menu.layout, context, "Preview Plane")
    menu.layout.operator(PREFILTER_OT_end_plane.bl_idname, icon="X")


def _draw_preview(layout: bpy.types.UILayout, context: bpy.types.Context, text: str) -> None:
    operator = layout.operator(
        PREFILTER_OT_preview_plane.bl_idname, text=text, icon="VIEW_PERSPECTIVE"
    )
    operator.filter = context.window_manager.prefilter_plane.filter


register, unregister = registration(
    classes(PREFILTER_PT_plane), entry(PREFILTER_MT_image, _draw_image_menu)
)
