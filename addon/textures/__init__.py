# SPDX-License-Identifier: GPL-3.0-or-later

"""Mipmaps fitted to meshes: bakes, and previews of levels."""

from ..core.keys import Key
from ..core.registration import registration
from . import choices, menus, operators, panels, properties, view
from .gltf import panel as gltf_panel
from .gltf import properties as gltf_properties

MANUAL = {
    "bake": (
        *("bake", "bake_mipmaps", "bake_model", "model", "remove_levels"),
        *("export_mipmaps", "export_model"),
    ),
    "engines": ("gltf", "gltf_import"),
    "view": (
        *("view", "preview_levels", "end_preview", "plot_error"),
        *("preview_on_model", "end_model_preview"),
        *("show_weights", "show_source", "fill_unused"),
    ),
}
"""The pages about its operators and settings; see `manual.Manual`."""
PREFERENCES = choices.Preferences
"""Its part of the preferences; see `preferences.SubjectPreferences`."""
KEYS = (
    Key("bake_mipmaps", "M", "Image"),
    Key("bake_model", "M", "Object Mode"),
    Key("preview_levels", "P", "Image"),
)
"""The default shortcuts of its operators; see `keys.Keys`."""

register, unregister = registration(
    properties, gltf_properties, gltf_panel, view, operators, panels, menus
)
