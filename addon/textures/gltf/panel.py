# SPDX-License-Identifier: GPL-3.0-or-later

"""The panels in the dialogs of Blender's glTF exporter and importer.

Until Blender 5.1 both look up `draw_export` and `draw_import` in the add-on when a dialog opens.
Later versions have dictionaries in which add-ons register draw functions.
"""

import sys
from contextlib import suppress

import bpy

from ...core.preferences import PACKAGE
from ...core.sidebar import subpanel
from .properties import GROUP, IMPORT_GROUP

_MODULE = "io_scene_gltf2"


def draw_export(context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
    """Draws the panel; nothing after the add-on was disabled, when the exporter still calls
    this."""
    settings = getattr(context.scene, GROUP, None)
    if settings is None:
        return
    header, body = layout.panel("PREFILTER_gltf", default_closed=True)
    header.use_property_split = False
    header.prop(settings, "use_mipmaps")
    if body:
        body.active = settings.use_mipmaps
        body.prop(context.scene.prefilter_bake, "lookups")
        body.prop(settings, "texture_format")
        body.prop(settings, "effort")
        if settings.texture_format == "etc1s":
            body.prop(settings, "quality")
        body.prop(settings, "supercompression")
        body.prop(settings, "fallback")
        _, advanced = subpanel(body, "gltf_advanced", "Advanced")
        if advanced:
            advanced.prop(context.scene.prefilter_bake, "filter")


def draw_import(context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
    """Draws the panel; nothing after the add-on was disabled, when the importer still calls
    this."""
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
"""The draw functions, by the names of the exporter's and importer's dictionaries."""


def offer_panels() -> None:
    """Adds the panels to the dictionaries of the exporter and importer, if these are loaded."""
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
    """Adds the panels to the dialogs."""
    offer_panels()
    # At startup the exporter may be loaded after this add-on.
    bpy.app.timers.register(offer_panels, persistent=True)
    bpy.app.handlers.load_post.append(_offer_after_load)


def unregister() -> None:
    """Removes the panels from the dialogs."""
    bpy.app.handlers.load_post.remove(_offer_after_load)
    with suppress(ValueError):  # The timer has run already.
        bpy.app.timers.unregister(offer_panels)
    _withdraw_panels()
