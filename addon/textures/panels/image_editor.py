# SPDX-License-Identifier: GPL-3.0-or-later

"""The panel of the bake, in the sidebar of the Image and UV editors."""

from typing import Any

import bpy

from ...core.presets import PresetsPanel
from ...core.sidebar import ImagePanel, note
from ...core.translations import tr
from ..choices import FILE_FORMATS
from ..menus import BAKE_BUTTON
from ..operators.remove_levels import PREFILTER_OT_remove_levels
from ..operators.source import shown_image
from ..properties import BAKE


class PREFILTER_PT_bake(ImagePanel, PresetsPanel, bpy.types.Panel):
    """The button and the settings of the bake."""

    bl_label = "Mipmaps"
    presets = BAKE

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from ...bridge import level_images
        from .. import removal, users

        layout, settings = self.layout, context.scene.prefilter_bake
        BAKE_BUTTON.draw_main(layout, context, "Make Mipmaps")
        image = shown_image(context)
        if image is not None:
            text = users.describe_inputs(context, image, settings.objects, [settings.filter])
            note(layout, context, f"{text}, {_destination(settings)}", "INFO")
        settings.draw_collapsed(layout)
        if removal.has_levels(level_images.source_of_level(image) or image):
            layout.operator(PREFILTER_OT_remove_levels.bl_idname, icon="TRASH")


def _destination(settings: Any) -> str:
    """Returns the destination of the levels as text."""
    if settings.result != "file":
        return tr("as images") if settings.result == "images" else tr("as a preview")
    return tr("to {}").format(settings.filepath or FILE_FORMATS[settings.file_format].label)


register, unregister = bpy.utils.register_classes_factory((PREFILTER_PT_bake,))
