# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of glTF exports and imports as properties of the scene."""

import bpy

from ...core.properties import properties
from ...core.registration import registration, state
from .choices import GltfImportSettings, GltfSettings

GROUP = "prefilter_gltf"
IMPORT_GROUP = "prefilter_gltf_import"


class PREFILTER_PG_gltf(bpy.types.PropertyGroup):
    """The settings of exports, stored in the scene."""

    __annotations__ = properties(GltfSettings)


class PREFILTER_PG_gltf_import(bpy.types.PropertyGroup):
    """The settings of imports, stored in the scene."""

    __annotations__ = properties(GltfImportSettings)


register, unregister = registration(
    state(bpy.types.Scene, GROUP, PREFILTER_PG_gltf),
    state(bpy.types.Scene, IMPORT_GROUP, PREFILTER_PG_gltf_import),
)
