# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables: a panel in the Text editor's sidebar, and an entry in Image > Prefilter."""

import bpy

from ...core.menus import PREFILTER_MT_image
from ...core.properties import copy
from ...core.sidebar import main_button
from ..choices import TableSettings
from ..operators.sampling_table import PREFILTER_OT_sampling_table


class PREFILTER_PT_sampling_table(bpy.types.Panel):
    """Button and settings."""

    bl_label = "Sampling Table"
    bl_space_type = "TEXT_EDITOR"
    bl_region_type = "UI"
    bl_category = "Prefilter"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        place = main_button(self.layout, context, PREFILTER_OT_sampling_table)
        if place:
            _draw_make(place, context, "Make Table")
        context.scene.prefilter_sampling_table.draw_narrow(self.layout)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (PREFILTER_PT_sampling_table,)
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
    _draw_make(menu.layout, context, PREFILTER_OT_sampling_table.bl_label)


def _draw_make(layout: bpy.types.UILayout, context: bpy.types.Context, text: str) -> None:
    operator = layout.operator(PREFILTER_OT_sampling_table.bl_idname, text=text, icon="TEXTURE")
    copy(context.scene.prefilter_sampling_table, operator, TableSettings)
