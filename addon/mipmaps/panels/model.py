# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of all images, in the Prefilter tab of the 3D view's sidebar."""

import bpy

from ...core.presets import PresetsPanel
from ...core.sidebar import SidebarPanel, subpanel
from ..choices import CONTENTS
from ..menus import MODEL_BUTTON
from ..properties import MODEL

_ICONS = {
    "color": "IMAGE_RGB",
    "cutout": "IMAGE_RGB_ALPHA",
    "data": "IMAGE_ALPHA",
    "normal": "NORMALS_FACE",
}
_MOST_IMAGES = 12


class PREFILTER_PT_model(SidebarPanel, PresetsPanel, bpy.types.Panel):
    """The button, the settings, and what there is to bake."""

    bl_label = "Mipmaps of All Images"
    wanted = "a mesh"
    presets = MODEL
    bl_options = frozenset({"DEFAULT_CLOSED"})

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object."""
        from ...bridge.meshes import may_show_image

        return may_show_image(obj)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from ..model import known

        layout, settings = self.layout, context.scene.prefilter_model
        MODEL_BUTTON.draw_main(layout, context)
        is_beside = settings.result == "file" and settings.folder.startswith("//")
        if is_beside and not bpy.data.is_saved:
            layout.label(text="Save the .blend file first", icon="ERROR")
        settings.draw_in(layout)
        found = known.images(context, settings.objects, settings.material) or []
        header, body = subpanel(layout, "model_images", "Images")
        header.label(text=str(len(found)))
        if not body:
            return
        column = body.column(align=True)
        for one in found[:_MOST_IMAGES]:
            row = column.row()
            row.label(text=one.image, icon=_ICONS[one.content])
            row.label(text="Roughness" if one.partner else CONTENTS[one.content].label)
        if len(found) > _MOST_IMAGES:
            column.label(text=f"and {len(found) - _MOST_IMAGES} more", icon="BLANK1")


register, unregister = bpy.utils.register_classes_factory((PREFILTER_PT_model,))
