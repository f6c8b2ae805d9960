# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing: a panel in the Image editor's sidebar, and an entry in Image > Prefilter."""

import bpy

from ...core.menus import PREFILTER_MT_image
from ...core.presets import PresetsPanel
from ...core.properties import copy
from ...core.sidebar import ImagePanel, main_button
from ..choices import ResizeSettings
from ..operators.resize_image import PREFILTER_OT_resize_image
from ..properties import RESIZE


class PREFILTER_PT_resize(ImagePanel, PresetsPanel, bpy.types.Panel):
    """Button and settings."""

    bl_label = "Resize"
    presets = RESIZE
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = context.scene.prefilter_resize
        place = main_button(self.layout, context, PREFILTER_OT_resize_image)
        if place:
            _draw_resize(place, context)
        image = context.space_data.image
        if image is not None and all(image.size):
            width, height = settings.to_settings().new_size(*image.size)
            text = f"{image.size[0]} x {image.size[1]} to {width} x {height}"
            self.layout.label(text=text, icon="INFO")
        settings.draw_in(self.layout)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory((PREFILTER_PT_resize,))


def register() -> None:
    """Registers the panel and the menu entry."""
    _register_classes()
    PREFILTER_MT_image.append(_draw_image_menu)


def unregister() -> None:
    """Removes them."""
    PREFILTER_MT_image.remove(_draw_image_menu)
    _unregister_classes()


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_resize(menu.layout, context)


def _draw_resize(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    operator = layout.operator(PREFILTER_OT_resize_image.bl_idname, icon="FULLSCREEN_ENTER")
    copy(context.scene.prefilter_resize, operator, ResizeSettings)
