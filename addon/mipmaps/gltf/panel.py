# SPDX-License-Identifier: GPL-3.0-or-later

"""The panels in the dialogs of Blender's glTF exporter and importer.

Until Blender 5.1 both ask the add-on for `draw_export` and `draw_import` when a dialog opens. Later
ones draw what add-ons have put into dictionaries of theirs.
"""

import sys
from contextlib import suppress

import bpy

from ...core.preferences import PACKAGE
from .properties import GROUP, IMPORT_GROUP

_MODULE = "io_scene_gltf2"


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


_PANELS = {
    "exporter_extension_layout_draw": draw_export,
    "importer_extension_layout_draw": draw_import,
}
"""By the dictionaries that have them, under the name that the exporter would use itself."""


def offer_panels() -> None:
    """Puts the panels into the exporter's and importer's dictionaries, where these are loaded."""
    module = sys.modules.get(_MODULE)
    for name, draw in _PANELS.items():
        if hasattr(module, name):
            getattr(module, name)[PACKAGE] = draw


def _withdraw_panels() -> None:
    module = sys.modules.get(_MODULE)
    for name in _PANELS:
        getattr(module, name, {}).pop(PACKAGE, None)


@bpy.app.handlers.persistent
def _offer_after_load(_file: str) -> None:
    offer_panels()


def register() -> None:
    """Has the dialogs show the panels."""
    offer_panels()
    # At startup the exporter may come after this add-on.
    bpy.app.timers.register(offer_panels, persistent=True)
    bpy.app.handlers.load_post.append(_offer_after_load)


def unregister() -> None:
    """Takes the panels back."""
    bpy.app.handlers.load_post.remove(_offer_after_load)
    with suppress(ValueError):  # It has run.
        bpy.app.timers.unregister(offer_panels)
    _withdraw_panels()
