# SPDX-License-Identifier: GPL-3.0-or-later

"""The panel of the bake of all images, in the sidebar of the 3D view."""

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
    """The button, the settings, and the images to bake."""

    bl_label = "Mipmaps"
    required_object = "a mesh"
    presets = MODEL

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Returns whether an object may show an image."""
        from ...bridge.meshes import may_show_image

        return may_show_image(obj)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from ..model import candidates

        layout, settings = self.layout, context.scene.prefilter_model
        MODEL_BUTTON.draw_main(layout, context, "Make Mipmaps")
        images = candidates.candidates(context, settings.objects, settings.material) or []
        reason = candidates.missing_reason(context, settings.objects, settings.material)
        note(layout, context, reason or _summary(context, settings, len(images)), "INFO")
        is_beside = settings.result == "file" and settings.folder.startswith("//")
        if images and is_beside and not bpy.data.is_saved:
            note(layout, context, "Save the .blend file first", "ERROR")
        settings.draw_collapsed(layout)
        header, body = subpanel(layout, "model_images", "Images")
        header.label(text=str(len(images)))
        if not body:
            return
        column = body.column(align=True)
        for image in images[:_MOST_IMAGES]:
            row = column.row()
            row.label(text=image.image, icon=_ICONS[image.content], translate=False)
            label = marked("Roughness") if image.partner else CONTENTS[image.content].label
            row.label(text=label, text_ctxt=CONTEXT)
        if len(images) > _MOST_IMAGES:
            column.label(text=tr("and {} more").format(len(images) - _MOST_IMAGES), icon="BLANK1")


def _summary(context: bpy.types.Context, settings: Any, count: int) -> str:
    """Returns the number of images, the objects, and the destination as text."""
    from ..model import candidates

    is_all = candidates.chosen_objects(context, settings.objects) is None
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
