# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxelizing and booleans: a tab in the 3D view's sidebar, under Remesh, in the Object menu."""

import bpy

from ..core.buttons import Button, SettingsPanel
from ..core.menus import PREFILTER_MT_object
from ..core.registration import classes, entry, registration
from ..core.sidebar import SidebarPanel, Tab, main_button, note
from ..core.translations import tr
from .choices import BooleanSettings, VoxelizeSettings
from .operators.boolean import PREFILTER_OT_boolean
from .operators.update import PREFILTER_OT_update_voxels
from .operators.voxelize import PREFILTER_OT_voxelize
from .properties import BOOLEAN, VOXELIZE


class _RemeshPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"


class _SidebarPanel(SidebarPanel):
    required_object = "a mesh, a curve, a text or a metaball"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Whether the panel applies to an object."""
        from ..bridge.new_meshes import is_solid

        return is_solid(obj)


_VOXELIZE = Button(PREFILTER_OT_voxelize, "MOD_REMESH", VOXELIZE.group, {VoxelizeSettings: ()})
_BOOLEAN = Button(PREFILTER_OT_boolean, "MOD_BOOLEAN", BOOLEAN.group, {BooleanSettings: ()})


class _BooleanPanel:
    """A mixin: subpanel of Voxelize, which has the shared settings."""

    bl_options = frozenset({"DEFAULT_CLOSED"})
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from ..bridge.units import length
        from .memory import cell_of

        _BOOLEAN.draw_main(self.layout, context, "Make Boolean")
        settings = context.scene.prefilter_boolean
        settings.draw_own(self.layout)
        cell = cell_of(context.active_object) if settings.use_keep_resolution else 0.0
        if cell > 0.0:
            text = tr("Cells of {}").format(length(cell))
            note(self.layout, context, text, "INFO")


class PREFILTER_PT_voxelize(_RemeshPanel, SettingsPanel, bpy.types.Panel):
    """Button and settings of voxelizing, in the properties of a mesh."""

    bl_label = "Prefilter Voxelize"
    bl_parent_id = "DATA_PT_remesh"
    bl_options = frozenset({"DEFAULT_CLOSED"})
    presets = VOXELIZE
    button = _VOXELIZE
    makes = "Make Solid"


class PREFILTER_PT_boolean(_BooleanPanel, _RemeshPanel, bpy.types.Panel):
    """Button and settings of booleans, in the properties of a mesh."""

    bl_label = "Prefilter Boolean"
    bl_parent_id = "PREFILTER_PT_voxelize"


class PREFILTER_PT_voxelize_sidebar(_SidebarPanel, SettingsPanel, bpy.types.Panel):
    """Button and settings of voxelizing, in the sidebar."""

    bl_label = "Voxelize"
    presets = VOXELIZE
    button = _VOXELIZE
    makes = "Make Solid"


class PREFILTER_PT_voxelize_sculpt(_SidebarPanel, SettingsPanel, bpy.types.Panel):
    """Button and settings of voxelizing in Sculpt Mode, in the sidebar."""

    bl_label = "Voxelize"
    bl_context = "sculpt_mode"
    mode = "SCULPT"
    presets = VOXELIZE
    button = _VOXELIZE
    makes = "Make Solid"


class PREFILTER_PT_boolean_sidebar(_BooleanPanel, _SidebarPanel, bpy.types.Panel):
    """Button and settings of booleans, in the sidebar."""

    bl_label = "Voxel Boolean"
    bl_parent_id = "PREFILTER_PT_voxelize_sidebar"


class PREFILTER_PT_voxel_result(Tab, bpy.types.Panel):
    """Button that updates a result, and its recipe."""

    bl_label = "Voxel Result"
    bl_context = "objectmode"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is a result to update for the active object."""
        from .memory import updatable_result

        return updatable_result(context.active_object) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from .memory import updatable_result

        result = updatable_result(context.active_object)
        assert result is not None
        row = main_button(self.layout, context, PREFILTER_OT_update_voxels)
        if row:
            update = PREFILTER_OT_update_voxels.bl_idname
            row.operator(update, text="Update", icon="FILE_REFRESH")
            is_source = result.prefilter_made_of.is_source_shown
            icon = "LOOP_FORWARDS" if is_source else "LOOP_BACK"
            row.operator("prefilter.switch_source", text="", icon=icon)
        if result != context.active_object:
            note(self.layout, context, f"'{result.name}'", "OBJECT_DATA")
        result.prefilter_voxels.draw_collapsed(self.layout)


def _draw_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    _VOXELIZE.draw(menu.layout, context)
    _BOOLEAN.draw(menu.layout, context)
    menu.layout.operator(PREFILTER_OT_update_voxels.bl_idname, icon="FILE_REFRESH")


def _draw_sculpt_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _VOXELIZE.draw(menu.layout, context)


register, unregister = registration(
    classes(
        PREFILTER_PT_voxelize,
        PREFILTER_PT_boolean,
        PREFILTER_PT_voxelize_sidebar,
        PREFILTER_PT_voxelize_sculpt,
        PREFILTER_PT_boolean_sidebar,
        PREFILTER_PT_voxel_result,
    ),
    entry(PREFILTER_MT_object, _draw_menu),
    entry(bpy.types.VIEW3D_MT_sculpt, _draw_sculpt_menu),
)
