# SPDX-License-Identifier: GPL-3.0-or-later

"""The panel of previews on models, in the sidebar of the 3D view."""

import bpy

from ...core.sidebar import Tab, button, note
from ...core.translations import CONTEXT, tr
from ..operators.preview_on_model import (
    PREFILTER_OT_end_model_preview,
    PREFILTER_OT_preview_on_model,
)
from ..view import on_model, preview


class PREFILTER_PT_on_model(Tab, bpy.types.Panel):
    """The button, and the choice of levels to draw."""

    bl_label = "Levels on Model"
    bl_parent_id = "PREFILTER_PT_model"
    bl_context = "objectmode"
    bl_options = frozenset({"DEFAULT_CLOSED"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the active object may show an image."""
        from ...bridge.meshes import may_show_image

        return context.active_object is not None and may_show_image(context.active_object)

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        if on_model.current() is not None:
            self.layout.prop(context.window_manager.prefilter_view, "use_model", text="")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout, settings = self.layout, context.window_manager.prefilter_view
        layout.use_property_split = True
        layout.use_property_decorate = False
        image, shown = on_model.shown_image(), on_model.current()
        place = button(layout, context, PREFILTER_OT_preview_on_model)
        if place:
            row = place.row(align=True)
            name = PREFILTER_OT_preview_on_model.bl_idname
            operator = row.operator(name, icon="SHADING_TEXTURE")
            operator.compare = settings.compare
            if shown is not None:
                row.operator(PREFILTER_OT_end_model_preview.bl_idname, text="", icon="X")
        if image is not None and shown is not None:
            self._draw_shown(context, image, shown)
        layout.prop(settings, "compare")

    def _draw_shown(
        self, context: bpy.types.Context, image: bpy.types.Image, shown: preview.Preview
    ) -> None:
        layout, settings = self.layout, context.window_manager.prefilter_view
        note(layout, context, tr("Levels of '{}'").format(image.name), "IMAGE_DATA")
        now = preview.settings_for_preview(context.scene.prefilter_bake.to_settings())
        if shown.is_stale:
            layout.label(text="The image or a mesh has changed", icon="ERROR")
        elif shown.settings != now:
            layout.label(text="The settings have changed", icon="ERROR")
        elif settings.compare not in shown.levels:
            layout.label(text="The filter has changed", icon="ERROR")
        column = layout.column()
        column.active = settings.use_model
        column.prop(settings, "choice")
        column.prop(settings, "distance" if settings.choice == "distance" else "mip_value")
        row = column.row(heading="Wipe", heading_ctxt=CONTEXT)
        row.prop(settings, "use_wipe", text="")
        part = row.row()
        part.active = settings.use_wipe
        part.prop(settings, "wipe", text="", slider=True)


register, unregister = bpy.utils.register_classes_factory((PREFILTER_PT_on_model,))
