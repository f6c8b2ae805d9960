# SPDX-License-Identifier: GPL-3.0-or-later

"""What works on images, in the menus Image > Prefilter and Object > Prefilter."""

import bpy

from ..core.menus import PREFILTER_MT_image, PREFILTER_MT_object
from ..core.properties import copy
from .choices import NOT_OF_MODELS, ModelSettings, ResultSettings, Settings
from .operators.bake_mipmaps import PREFILTER_OT_bake_mipmaps
from .operators.bake_model import PREFILTER_OT_bake_model
from .operators.fill_unused import PREFILTER_OT_fill_unused
from .operators.plot_error import PREFILTER_OT_plot_error
from .operators.preview_levels import PREFILTER_OT_end_preview, PREFILTER_OT_preview_levels
from .operators.remove_levels import PREFILTER_OT_remove_levels
from .operators.show_weights import PREFILTER_OT_show_source, PREFILTER_OT_show_weights


def register() -> None:
    """Adds the entries."""
    PREFILTER_MT_image.append(_draw_image_menu)
    PREFILTER_MT_object.append(_draw_object_menu)
    bpy.types.MATERIAL_MT_context_menu.append(_draw_material_menu)


def unregister() -> None:
    """Removes them."""
    bpy.types.MATERIAL_MT_context_menu.remove(_draw_material_menu)
    PREFILTER_MT_object.remove(_draw_object_menu)
    PREFILTER_MT_image.remove(_draw_image_menu)


def draw_bake(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws the button of the bake, with the settings of the scene."""
    operator = layout.operator(PREFILTER_OT_bake_mipmaps.bl_idname, icon="TEXTURE")
    copy(context.scene.prefilter_bake, operator, ResultSettings)
    copy(context.scene.prefilter_bake, operator, Settings)


def draw_bake_model(
    layout: bpy.types.UILayout, context: bpy.types.Context, text: str | None = None
) -> bpy.types.OperatorProperties:
    """Draws the button of the bake of all images, with the settings of the scene."""
    operator = layout.operator(PREFILTER_OT_bake_model.bl_idname, text=text, icon="RENDERLAYERS")
    copy(context.scene.prefilter_model, operator, ModelSettings)
    copy(context.scene.prefilter_model, operator, Settings, NOT_OF_MODELS)
    return operator


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    layout, view = menu.layout, context.window_manager.prefilter_view
    draw_bake(layout, context)
    draw_bake_model(layout, context)
    layout.separator()
    preview = layout.operator(PREFILTER_OT_preview_levels.bl_idname, icon="FILE_REFRESH")
    preview.compare = view.compare
    layout.operator(PREFILTER_OT_end_preview.bl_idname, icon="X")
    layout.operator(PREFILTER_OT_remove_levels.bl_idname, icon="TRASH")
    layout.operator(PREFILTER_OT_plot_error.bl_idname, icon="FCURVE").filters = view.plot_filters
    layout.operator(PREFILTER_OT_show_weights.bl_idname, icon="TEXTURE")
    layout.operator(PREFILTER_OT_show_source.bl_idname, icon="LOOP_BACK")
    layout.separator()
    layout.operator(PREFILTER_OT_fill_unused.bl_idname, icon="SNAP_FACE")


def _draw_object_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    draw_bake(menu.layout, context)
    draw_bake_model(menu.layout, context)


def _draw_material_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    material = getattr(context, "material", None)
    if material is None:
        return
    menu.layout.separator()
    operator = draw_bake_model(menu.layout, context, "Bake All Images of Material")
    operator.objects, operator.material = "scene", material.name
