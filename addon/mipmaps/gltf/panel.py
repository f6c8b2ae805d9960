# SPDX-License-Identifier: GPL-3.0-or-later

"""The panels in the dialogs of Blender's glTF exporter and importer, which ask for them by name."""

import bpy

from .properties import GROUP, IMPORT_GROUP


def draw_export(context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
    """Draws the panel; the exporter goes on to ask for it after the add-on was disabled."""
    settings = getattr(context.scene, GROUP, None)
    if settings is None:
        return
    header, body = layout.panel("PREFILTER_gltf", default_closed=True)
    header.use_property_split = False
    header.prop(settings, "use_mipmaps")
    if body:
        body.active = settings.use_mipmaps
        body.prop(context.scene.prefilter_bake, "filter")
        body.prop(context.scene.prefilter_bake, "lookups")
        body.prop(settings, "texture_format")
        body.prop(settings, "effort")
        if settings.texture_format == "etc1s":
            body.prop(settings, "quality")
        body.prop(settings, "supercompression")
        body.prop(settings, "fallback")


def draw_import(context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
    """Draws the panel; the importer goes on to ask for it after the add-on was disabled."""
    settings = getattr(context.scene, IMPORT_GROUP, None)
    if settings is None:
        return
    header, body = layout.panel("PREFILTER_gltf_import", default_closed=True)
    header.label(text="Prefilter Mipmaps", icon="TEXTURE")
    if body:
        body.prop(settings, "keep_levels")
