# SPDX-License-Identifier: GPL-3.0-or-later

"""Entries for mipmaps in the menus Image > Prefilter, Object > Prefilter and File > Export."""

import bpy

from ..core.buttons import Button
from ..core.menus import PREFILTER_MT_image, PREFILTER_MT_object
from ..core.registration import entry, registration
from ..core.translations import marked
from .choices import NOT_OF_MODELS, ModelSettings, ResultSettings, Settings
from .gltf.panel import offer_panels
from .operators.bake_mipmaps import PREFILTER_OT_bake_mipmaps
from .operators.bake_model import PREFILTER_OT_bake_model
from .operators.export import PREFILTER_OT_export_mipmaps, PREFILTER_OT_export_model
from .operators.fill_unused import PREFILTER_OT_fill_unused
from .operators.plot_error import PREFILTER_OT_plot_error
from .operators.preview_levels import PREFILTER_OT_end_preview, PREFILTER_OT_preview_levels
from .operators.preview_on_model import (
    PREFILTER_OT_end_model_preview,
    PREFILTER_OT_preview_on_model,
)
from .operators.remove_levels import PREFILTER_OT_remove_levels
from .operators.show_weights import PREFILTER_OT_show_source, PREFILTER_OT_show_weights
from .properties import BAKE, MODEL

BAKE_BUTTON = Button(
    PREFILTER_OT_bake_mipmaps, "TEXTURE", BAKE.group, {ResultSettings: (), Settings: ()}
)
MODEL_BUTTON = Button(
    PREFILTER_OT_bake_model,
    "RENDERLAYERS",
    MODEL.group,
    {ModelSettings: (), Settings: NOT_OF_MODELS},
)


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    layout, view = menu.layout, context.window_manager.prefilter_view
    BAKE_BUTTON.draw(layout, context)
    MODEL_BUTTON.draw(layout, context)
    layout.separator()
    preview = layout.operator(PREFILTER_OT_preview_levels.bl_idname, icon="FILE_REFRESH")
    preview.compare = view.compare
    layout.operator(PREFILTER_OT_end_preview.bl_idname, icon="X")
    layout.operator(PREFILTER_OT_remove_levels.bl_idname, icon="TRASH")
    layout.operator(PREFILTER_OT_plot_error.bl_idname, icon="FCURVE").filters = view.plot_filters
    layout.operator(PREFILTER_OT_show_weights.bl_idname, icon="MOD_VERTEX_WEIGHT")
    layout.operator(PREFILTER_OT_show_source.bl_idname, icon="LOOP_BACK")
    layout.separator()
    layout.operator(PREFILTER_OT_fill_unused.bl_idname, icon="SNAP_FACE")


def _draw_object_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    BAKE_BUTTON.draw(menu.layout, context)
    MODEL_BUTTON.draw(menu.layout, context)
    name = PREFILTER_OT_preview_on_model.bl_idname
    preview = menu.layout.operator(name, icon="SHADING_TEXTURE")
    preview.compare = context.window_manager.prefilter_view.compare
    menu.layout.operator(PREFILTER_OT_end_model_preview.bl_idname, icon="X")


def _draw_material_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    material = getattr(context, "material", None)
    if material is None:
        return
    menu.layout.separator()
    text = "Bake All Images of Material"
    operator = MODEL_BUTTON.draw(menu.layout, context, text, is_changed=True)
    operator.objects, operator.material = "scene", material.name


def _draw_export(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    offer_panels()  # The glTF exporter may have been enabled since registration.
    for operator, text in (
        (PREFILTER_OT_export_mipmaps, marked("Mipmaps (.ktx2/.dds/.exr/.tx/.tif/.png)")),
        (PREFILTER_OT_export_model, marked("Mipmaps of All Images")),
    ):
        menu.layout.operator(operator.bl_idname, text=text)


register, unregister = registration(
    entry(PREFILTER_MT_image, _draw_image_menu),
    entry(PREFILTER_MT_object, _draw_object_menu),
    entry(bpy.types.MATERIAL_MT_context_menu, _draw_material_menu),
    entry(bpy.types.TOPBAR_MT_file_export, _draw_export),
)
