# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxelizing and booleans: a tab in the 3D view's sidebar, under Remesh, in the Object menu."""

import bpy

from ..core.buttons import Button, SettingsPanel
from ..core.menus import PREFILTER_MT_object
from ..core.registration import classes, entry, registration
from ..core.sidebar import SidebarPanel
from .choices import BooleanSettings, VoxelizeSettings
from .operators.boolean import PREFILTER_OT_boolean
from .operators.voxelize import PREFILTER_OT_voxelize
from .properties import BOOLEAN, VOXELIZE


class _RemeshPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"


class _SidebarPanel(SidebarPanel):
    wanted = "a mesh, a curve, a text or a metaball"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object."""
        from ..bridge.new_meshes import is_solid

        return is_solid(obj)


_VOXELIZE = Button(PREFILTER_OT_voxelize, "MOD_REMESH", VOXELIZE.group, {VoxelizeSettings: ()})
_BOOLEAN = Button(PREFILTER_OT_boolean, "MOD_BOOLEAN", BOOLEAN.group, {BooleanSettings: ()})


class _BooleanPanel:
    """A mixin: in the panel of voxelizing, which has the other settings."""

    bl_options = frozenset({"DEFAULT_CLOSED"})
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        _BOOLEAN.draw_main(self.layout, context, "Make Boolean")
        context.scene.prefilter_boolean.draw_own(self.layout)


class PREFILTER_PT_voxelize(_RemeshPanel, SettingsPanel, bpy.types.Panel):
    """Button and settings of voxelizing, of meshes."""

    bl_label = "Prefilter Voxelize"
    bl_parent_id = "DATA_PT_remesh"
    bl_options = frozenset({"DEFAULT_CLOSED"})
    presets = VOXELIZE
    button = _VOXELIZE
    makes = "Make Solid"


class PREFILTER_PT_boolean(_BooleanPanel, _RemeshPanel, bpy.types.Panel):
    """Button and own settings of booleans, of meshes."""

    bl_label = "Prefilter Boolean"
    bl_parent_id = "PREFILTER_PT_voxelize"


class PREFILTER_PT_voxelize_sidebar(_SidebarPanel, SettingsPanel, bpy.types.Panel):
    """Button and settings of voxelizing."""

    bl_label = "Voxelize"
    presets = VOXELIZE
    button = _VOXELIZE
    makes = "Make Solid"


class PREFILTER_PT_boolean_sidebar(_BooleanPanel, _SidebarPanel, bpy.types.Panel):
    """Button and own settings of booleans."""

    bl_label = "Voxel Boolean"
    bl_parent_id = "PREFILTER_PT_voxelize_sidebar"


def _draw_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    _VOXELIZE.draw(menu.layout, context)
    _BOOLEAN.draw(menu.layout, context)


register, unregister = registration(
    classes(
        PREFILTER_PT_voxelize,
        PREFILTER_PT_boolean,
        PREFILTER_PT_voxelize_sidebar,
        PREFILTER_PT_boolean_sidebar,
    ),
    entry(PREFILTER_MT_object, _draw_menu),
)
