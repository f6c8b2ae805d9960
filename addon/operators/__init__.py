"""One file an operator: read from Blender, call prefilter, write to Blender."""

import bpy

from .bake_mipmaps import PREFILTER_OT_bake_mipmaps
from .bake_texture_cache import PREFILTER_OT_bake_texture_cache

_CLASSES = (PREFILTER_OT_bake_mipmaps, PREFILTER_OT_bake_texture_cache)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
