# SPDX-License-Identifier: GPL-3.0-or-later

"""Reconstructing: a tab in the 3D view's sidebar, entries in the Object and the Convert menu."""

import bpy

from ..core.menus import PREFILTER_MT_object
from ..core.presets import PresetsPanel
from ..core.properties import copy
from ..core.sidebar import SidebarPanel, main_button
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


class PREFILTER_PT_reconstruct(_SidebarPanel, PresetsPanel, bpy.types.Panel):
    """Button and settings."""

    bl_label = "Reconstruct Surface"
    presets = RECONSTRUCT

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        place = main_button(self.layout, context, PREFILTER_OT_reconstruct)
        if place:
            _draw_reconstruct(place, context)
        context.scene.prefilter_reconstruct.draw_in(self.layout)


class PREFILTER_MT_scans(bpy.types.Menu):
    """What makes something of scans.

    Object > Prefilter and Object > Convert both have this menu, rather than its entries: a search
    (F3) goes through each menu once.
    """

    bl_label = "Scans"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the menu."""
        _draw_reconstruct(self.layout, context)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (PREFILTER_PT_reconstruct, PREFILTER_MT_scans)
)


def register() -> None:
    """Registers the panels and the menu entries."""
    _register_classes()
    PREFILTER_MT_object.append(_draw_object_menu)
    bpy.types.VIEW3D_MT_object_convert.append(_draw_convert_menu)


def unregister() -> None:
    """Removes them."""
    bpy.types.VIEW3D_MT_object_convert.remove(_draw_convert_menu)
    PREFILTER_MT_object.remove(_draw_object_menu)
    _unregister_classes()


def _draw_object_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.menu(PREFILTER_MT_scans.__name__)


def _draw_convert_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.separator()
    menu.layout.menu(PREFILTER_MT_scans.__name__, text="Prefilter")


def _draw_reconstruct(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    operator = layout.operator(PREFILTER_OT_reconstruct.bl_idname, icon="POINTCLOUD_DATA")
    copy(context.scene.prefilter_reconstruct, operator, ScanSettings)
