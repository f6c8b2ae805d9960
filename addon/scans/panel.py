# SPDX-License-Identifier: GPL-3.0-or-later

"""Reconstructing: a tab in the 3D view's sidebar, entries in the Object and the Convert menu."""

import bpy

from ..core.buttons import Button, SettingsPanel
from ..core.menus import PREFILTER_MT_object
from ..core.registration import classes, entry, registration
from ..core.sidebar import SidebarPanel
from .choices import ScanSettings
from .operator import PREFILTER_OT_reconstruct
from .properties import RECONSTRUCT


class _SidebarPanel(SidebarPanel):
    wanted = "a point cloud, or a mesh without faces"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object."""
        from ..bridge.points import may_be_points

        return may_be_points(obj)


_RECONSTRUCT = Button(
    PREFILTER_OT_reconstruct, "POINTCLOUD_DATA", RECONSTRUCT.group, {ScanSettings: ()}
)


class PREFILTER_PT_reconstruct(_SidebarPanel, SettingsPanel, bpy.types.Panel):
    """Button and settings."""

    bl_label = "Reconstruct Surface"
    presets = RECONSTRUCT
    button = _RECONSTRUCT


class PREFILTER_MT_scans(bpy.types.Menu):
    """What makes something of scans.

    Object > Prefilter and Object > Convert both have this menu, rather than its entries: a search
    (F3) goes through each menu once.
    """

    bl_label = "Scans"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the menu."""
        _RECONSTRUCT.draw(self.layout, context)


def _draw_object_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.menu(PREFILTER_MT_scans.__name__)


def _draw_convert_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.separator()
    menu.layout.menu(PREFILTER_MT_scans.__name__, text="Prefilter")


register, unregister = registration(
    classes(PREFILTER_PT_reconstruct, PREFILTER_MT_scans),
    entry(PREFILTER_MT_object, _draw_object_menu),
    entry(bpy.types.VIEW3D_MT_object_convert, _draw_convert_menu),
)
