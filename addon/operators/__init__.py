"""One file an operator: read from Blender, call prefilter, write to Blender."""

import bpy

from .bake_mipmaps import PREFILTER_OT_bake_mipmaps

_CLASSES = (PREFILTER_OT_bake_mipmaps,)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
