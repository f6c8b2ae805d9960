# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of a glTF export as properties of the scene."""

import bpy

from ...core.properties import properties
from ...core.registration import registration, state
from .choices import GltfSettings

GROUP = "prefilter_gltf"


class PREFILTER_PG_gltf(bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""

    __annotations__ = properties(GltfSettings)


register, unregister = registration(state(bpy.types.Scene, GROUP, PREFILTER_PG_gltf))
