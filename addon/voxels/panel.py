# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxelizing and booleans: a tab in the 3D view's sidebar, under Remesh, in the Object menu."""

import bpy

from ..core.menus import PREFILTER_MT_object
from ..core.presets import PresetsPanel
from ..core.properties import copy
from ..core.sidebar import SidebarPanel, main_button
from .choices import BooleanSettings, VoxelizeSettings
from .operators.boolean import PREFILTER_OT_boolean
from .operators.voxelize import PREFILTER_OT_voxelize
from .properties import BOOLEAN, VOXELIZE


class _RemeshPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"
    bl_parent_id = "DATA_PT_remesh"
    bl_options = frozenset({"DEFAULT_CLOSED"})


class _SidebarPanel(SidebarPanel):
    wanted = "a mesh, a curve, a text or a metaball"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object."""
        from ..bridge.new_meshes import is_solid

        return is_solid(obj)


class _VoxelizePanel:
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        place = main_button(self.layout, context, PREFILTER_OT_voxelize)
        if place:
            _draw_voxelize(place, context)
        context.scene.prefilter_voxelize.draw_in(self.layout)


class _BooleanPanel:
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        place = main_button(self.layout, context, PREFILTER_OT_boolean)
        if place:
            _draw_boolean(place, context)
        context.scene.prefilter_boolean.draw_in(self.layout)


class PREFILTER_PT_voxelize(_VoxelizePanel, _RemeshPanel, PresetsPanel, bpy.types.Panel):
    """Button and settings of voxelizing, of meshes."""

    bl_label = "Prefilter Voxelize"
    presets = VOXELIZE


class PREFILTER_PT_boolean(_BooleanPanel, _RemeshPanel, PresetsPanel, bpy.types.Panel):
    """Button and settings of booleans, of meshes."""

    bl_label = "Prefilter Boolean"
    presets = BOOLEAN


class PREFILTER_PT_voxelize_sidebar(_VoxelizePanel, _SidebarPanel, PresetsPanel, bpy.types.Panel):
    """Button and settings of voxelizing."""

    bl_label = "Voxelize"
    presets = VOXELIZE


class PREFILTER_PT_boolean_sidebar(_BooleanPanel, _SidebarPanel, PresetsPanel, bpy.types.Panel):
    """Button and settings of booleans."""

    bl_label = "Voxel Boolean"
    presets = BOOLEAN


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (
        PREFILTER_PT_voxelize,
        PREFILTER_PT_boolean,
        PREFILTER_PT_voxelize_sidebar,
        PREFILTER_PT_boolean_sidebar,
    )
)


def register() -> None:
    """Registers the panels and the menu entries."""
    _register_classes()
    PREFILTER_MT_object.append(_draw_menu)


def unregister() -> None:
    """Removes them."""
    PREFILTER_MT_object.remove(_draw_menu)
    _unregister_classes()


def _draw_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    _draw_voxelize(menu.layout, context)
    _draw_boolean(menu.layout, context)


def _draw_voxelize(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    operator = layout.operator(PREFILTER_OT_voxelize.bl_idname, icon="MOD_REMESH")
    copy(context.scene.prefilter_voxelize, operator, VoxelizeSettings)


def _draw_boolean(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    operator = layout.operator(PREFILTER_OT_boolean.bl_idname, icon="MOD_BOOLEAN")
    copy(context.scene.prefilter_boolean, operator, BooleanSettings)
