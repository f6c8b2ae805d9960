"""Voxelizing and booleans under Remesh in the mesh properties, and in the Object menus."""

import bpy

from ..core.properties import copy
from .choices import BooleanSettings, VoxelizeSettings
from .operators.boolean import PREFILTER_OT_boolean
from .operators.voxelize import PREFILTER_OT_voxelize

_PARENT = "DATA_PT_remesh"


class _VoxelPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"
    bl_parent_id = _PARENT
    bl_options = frozenset({"DEFAULT_CLOSED"})


class PREFILTER_PT_voxelize(_VoxelPanel, bpy.types.Panel):
    """Settings and button of voxelizing."""

    bl_label = "Prefilter Voxelize"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        context.scene.prefilter_voxelize.draw_in(self.layout)
        _draw_voxelize(self.layout, context)


class PREFILTER_PT_boolean(_VoxelPanel, bpy.types.Panel):
    """Settings and button of booleans."""

    bl_label = "Prefilter Boolean"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        context.scene.prefilter_boolean.draw_in(self.layout)
        _draw_boolean(self.layout, context)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (PREFILTER_PT_voxelize, PREFILTER_PT_boolean)
)


def register() -> None:
    """Registers the panels and the menu entries."""
    _register_classes()
    bpy.types.VIEW3D_MT_object.append(_draw_object_menu)
    bpy.types.VIEW3D_MT_object_convert.append(_draw_convert_menu)


def unregister() -> None:
    """Removes them."""
    bpy.types.VIEW3D_MT_object_convert.remove(_draw_convert_menu)
    bpy.types.VIEW3D_MT_object.remove(_draw_object_menu)
    _unregister_classes()


def _draw_object_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_voxelize(menu.layout, context)
    _draw_boolean(menu.layout, context)


def _draw_convert_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_voxelize(menu.layout, context)


def _draw_voxelize(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    operator = layout.operator(PREFILTER_OT_voxelize.bl_idname, icon="MOD_REMESH")
    copy(context.scene.prefilter_voxelize, operator, VoxelizeSettings)


def _draw_boolean(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    operator = layout.operator(PREFILTER_OT_boolean.bl_idname, icon="MOD_BOOLEAN")
    copy(context.scene.prefilter_boolean, operator, BooleanSettings)
