"""Where a user finds the operators."""

import bpy

from . import image_editor, seeing, texture_cache, voxels

_CLASSES = (image_editor.PREFILTER_PT_bake, *seeing.CLASSES, *voxels.CLASSES)

_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_CLASSES)


def register() -> None:
    """Registers the panels and the menu entries."""
    seeing.load_swatches()
    _register_classes()
    bpy.types.IMAGE_MT_image.append(image_editor.draw_image_menu)
    bpy.types.IMAGE_MT_image.append(texture_cache.draw_image_menu)
    bpy.types.VIEW3D_MT_object.append(voxels.draw_object_menu)
    bpy.types.VIEW3D_MT_object_convert.append(voxels.draw_convert_menu)
    if texture_cache.has_parent():
        bpy.utils.register_class(texture_cache.PREFILTER_PT_texture_cache)


def unregister() -> None:
    """Removes the menu entries and the panels."""
    if texture_cache.PREFILTER_PT_texture_cache.is_registered:
        bpy.utils.unregister_class(texture_cache.PREFILTER_PT_texture_cache)
    bpy.types.VIEW3D_MT_object_convert.remove(voxels.draw_convert_menu)
    bpy.types.VIEW3D_MT_object.remove(voxels.draw_object_menu)
    bpy.types.IMAGE_MT_image.remove(texture_cache.draw_image_menu)
    bpy.types.IMAGE_MT_image.remove(image_editor.draw_image_menu)
    _unregister_classes()
    seeing.free_swatches()
