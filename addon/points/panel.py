# SPDX-License-Identifier: GPL-3.0-or-later

"""Panels in the 3D view's sidebar, and entries of the menu Object > Prefilter."""

import bpy

from ..core.buttons import Button, SettingsPanel
from ..core.menus import PREFILTER_MT_object
from ..core.registration import classes, entry, registration
from ..core.sidebar import SidebarPanel
from .choices import ScanSettings
from .operators.align_scans import PREFILTER_OT_align_scans
from .operators.crop_points import PREFILTER_OT_crop_points
from .operators.paint_texture import PREFILTER_OT_paint_texture
from .operators.reconstruct import PREFILTER_OT_reconstruct
from .operators.remove_outliers import PREFILTER_OT_remove_outliers
from .operators.subsample_points import PREFILTER_OT_subsample_points
from .operators.trim_reconstruction import PREFILTER_OT_trim_reconstruction
from .properties import RECONSTRUCT


class _SidebarPanel(SidebarPanel):
    required_object = "a point cloud, or a mesh without faces"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Whether the panel applies to an object."""
        from ..bridge.points import may_be_points

        return may_be_points(obj)


_RECONSTRUCT = Button(
    PREFILTER_OT_reconstruct, "POINTCLOUD_DATA", RECONSTRUCT.group, {ScanSettings: ()}
)


class PREFILTER_PT_reconstruct(_SidebarPanel, SettingsPanel, bpy.types.Panel):
    """Button and settings of the reconstruction."""

    bl_label = "Reconstruct Surface"
    presets = RECONSTRUCT
    button = _RECONSTRUCT
    makes = "Make Surface"


_STEPS = (
    (PREFILTER_OT_align_scans, "SNAP_ON"),
    (PREFILTER_OT_crop_points, "SELECT_SET"),
    (PREFILTER_OT_remove_outliers, "BRUSH_DATA"),
    (PREFILTER_OT_subsample_points, "STICKY_UVS_DISABLE"),
)
"""Operators that prepare points, in the usual order, each with its icon."""


class PREFILTER_PT_points(_SidebarPanel, bpy.types.Panel):
    """Buttons of the operators that prepare points."""

    bl_label = "Points"
    bl_parent_id = PREFILTER_PT_reconstruct.__name__
    bl_options = frozenset({"DEFAULT_CLOSED"})

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        del context
        _draw_steps(self.layout.column())


def _draw_steps(layout: bpy.types.UILayout) -> None:
    for operator, icon in _STEPS:
        layout.operator(operator.bl_idname, icon=icon)


def _draw_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    _RECONSTRUCT.draw(menu.layout, context)
    menu.layout.operator(PREFILTER_OT_trim_reconstruction.bl_idname, icon="MOD_BOOLEAN")
    menu.layout.operator(PREFILTER_OT_paint_texture.bl_idname, icon="TEXTURE")
    _draw_steps(menu.layout)


register, unregister = registration(
    classes(PREFILTER_PT_reconstruct, PREFILTER_PT_points), entry(PREFILTER_MT_object, _draw_menu)
)
