# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of all images, in the Prefilter tab of the 3D view's sidebar."""

from typing import Any

import bpy

from ...core.presets import PresetsPanel
from ...core.sidebar import SidebarPanel, note, subpanel
from ...core.translations import CONTEXT, marked, tr
from ...core.wording import counted
from ..choices import CONTENTS, FILE_FORMATS
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

    bl_label = "Mipmaps"
    wanted = "a mesh"
    presets = MODEL

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object."""
        from ...bridge.meshes import may_show_image

        return may_show_image(obj)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from ..model import known

        layout, settings = self.layout, context.scene.prefilter_model
        MODEL_BUTTON.draw_main(layout, context, "Make Mipmaps")
        found = known.images(context, settings.objects, settings.material) or []
        reason = known.why_none(context, settings.objects, settings.material)
        note(layout, context, reason or _what_is_made(context, settings, len(found)), "INFO")
        is_beside = settings.result == "file" and settings.folder.startswith("//")
        if found and is_beside and not bpy.data.is_saved:
            note(layout, context, "Save the .blend file first", "ERROR")
        settings.draw_closed(layout)
        header, body = subpanel(layout, "model_images", "Images")
        header.label(text=str(len(found)))
        if not body:
            return
        column = body.column(align=True)
        for one in found[:_MOST_IMAGES]:
            row = column.row()
            row.label(text=one.image, icon=_ICONS[one.content], translate=False)
            label = marked("Roughness") if one.partner else CONTENTS[one.content].label
            row.label(text=label, text_ctxt=CONTEXT)
        if len(found) > _MOST_IMAGES:
            column.label(text=tr("and {} more").format(len(found) - _MOST_IMAGES), icon="BLANK1")


def _what_is_made(context: bpy.types.Context, settings: Any, count: int) -> str:
    """Returns whose images are baked, and where their levels go."""
    from ..model import known

    is_all = known.chosen_objects(context, settings.objects) is None
    whose = tr("the scene") if is_all else tr("the selection")
    if settings.material:
        whose = tr("'{material}' in {whose}").format(material=settings.material, whose=whose)
    if settings.result == "file":
        kind = FILE_FORMATS[settings.file_format].label
        where = tr("to {}").format(f"{settings.folder}, {kind}")
    else:
        where = tr("as images")
    images = tr(counted(range(count), "image"))
    return tr("{images} of {whose} {where}").format(images=images, whose=whose, where=where)


register, unregister = bpy.utils.register_classes_factory((PREFILTER_PT_model,))
