# SPDX-License-Identifier: GPL-3.0-or-later

"""Resampling: a panel in the Image editor's sidebar, and an entry in Image > Prefilter."""

import bpy

from ...core.menus import PREFILTER_MT_image
from ...core.presets import PresetsPanel
from ...core.properties import copy
from ...core.sidebar import ImagePanel, main_button, note
from ..choices import ResampleSettings
from ..operators.resample_image import PREFILTER_OT_resample_image
from ..properties import RESAMPLE


class PREFILTER_PT_resample(ImagePanel, PresetsPanel, bpy.types.Panel):
    """Button and settings."""

    bl_label = "Resample"
    presets = RESAMPLE
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = context.scene.prefilter_resample
        place = main_button(self.layout, context, PREFILTER_OT_resample_image)
        if place:
            _draw_resample(place, context)
        image = context.space_data.image
        if image is not None and all(image.size):
            note(self.layout, context, *_what_comes_out(settings.to_settings(), *image.size))
        settings.draw_in(self.layout)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (PREFILTER_PT_resample,)
)


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
    _draw_resample(menu.layout, context)


def _draw_resample(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    operator = layout.operator(PREFILTER_OT_resample_image.bl_idname, icon="MOD_LATTICE")
    copy(context.scene.prefilter_resample, operator, ResampleSettings)


def _what_comes_out(settings: ResampleSettings, width: int, height: int) -> tuple[str, str]:
    """Returns the size of the result, or what is wrong, and an icon."""
    from ..placement import placement

    try:
        placed = placement(settings, width, height)
    except ValueError as error:
        return str(error), "ERROR"
    return f"{width} x {height} to {placed.width} x {placed.height}", "INFO"
