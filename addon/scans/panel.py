# SPDX-License-Identifier: GPL-3.0-or-later

"""Reconstructing: a tab in the 3D view's sidebar, an entry in Object > Prefilter."""

import bpy

from ..core.buttons import Button, SettingsPanel
from ..core.menus import PREFILTER_MT_object
from ..core.registration import classes, entry, registration
from ..core.sidebar import SidebarPanel
from .choices import ScanSettings
from .operators.reconstruct import PREFILTER_OT_reconstruct
from .operators.trim_reconstruction import PREFILTER_OT_trim_reconstruction
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
    makes = "Make Surface"


def _draw_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    _RECONSTRUCT.draw(menu.layout, context)
    menu.layout.operator(PREFILTER_OT_trim_reconstruction.bl_idname, icon="MOD_BOOLEAN")


register, unregister = registration(
    classes(PREFILTER_PT_reconstruct), entry(PREFILTER_MT_object, _draw_menu)
)
