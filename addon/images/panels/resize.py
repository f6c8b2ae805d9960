# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing: a panel in the Image editor's sidebar, and an entry in Image > Prefilter."""

import bpy

from ...core.buttons import Button, SettingsPanel
from ...core.menus import PREFILTER_MT_image
from ...core.registration import classes, entry, registration
from ...core.sidebar import ImagePanel
from ...core.translations import tr
from ..choices import ResizeSettings
from ..operators.resize_image import PREFILTER_OT_resize_image
from ..properties import RESIZE

_BUTTON = Button(PREFILTER_OT_resize_image, "FULLSCREEN_ENTER", RESIZE.group, {ResizeSettings: ()})


class PREFILTER_PT_resize(ImagePanel, SettingsPanel, bpy.types.Panel):
    """The button and the settings."""

    bl_label = "Resize"
    presets = RESIZE
    button = _BUTTON
    makes = "Make Resized Image"
    bl_parent_id = "PREFILTER_PT_resample"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_notes(self, context: bpy.types.Context) -> None:
        """Draws the size of the result."""
        settings = context.scene.prefilter_resize
        image = context.space_data.image
        if image is not None and all(image.size):
            width, height = settings.to_settings().new_size(*image.size)
            text = tr("{} x {} to {} x {}").format(*image.size, width, height)
            self.layout.label(text=text, icon="INFO")


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _BUTTON.draw(menu.layout, context)


register, unregister = registration(
    classes(PREFILTER_PT_resize), entry(PREFILTER_MT_image, _draw_image_menu)
)
