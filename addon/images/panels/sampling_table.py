# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables: a panel in the Text editor's sidebar, and an entry in Image > Prefilter."""

import bpy

from ...core.buttons import Button
from ...core.menus import PREFILTER_MT_image
from ...core.registration import classes, entry, registration
from ..choices import TableSettings
from ..operators.sampling_table import PREFILTER_OT_sampling_table

_BUTTON = Button(
    PREFILTER_OT_sampling_table, "TEXTURE", "prefilter_sampling_table", {TableSettings: ()}
)


class PREFILTER_PT_sampling_table(bpy.types.Panel):
    """The button and the settings."""

    bl_label = "Sampling Table"
    bl_space_type = "TEXT_EDITOR"
    bl_region_type = "UI"
    bl_category = "Prefilter"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        _BUTTON.draw_main(self.layout, context, "Make Table")
        context.scene.prefilter_sampling_table.draw_collapsed(self.layout)


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _BUTTON.draw(menu.layout, context)


register, unregister = registration(
    classes(PREFILTER_PT_sampling_table), entry(PREFILTER_MT_image, _draw_image_menu)
)
