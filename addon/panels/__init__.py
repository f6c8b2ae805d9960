"""Where a user finds the operators."""

import bpy

from . import image_editor, seeing

_CLASSES = (image_editor.PREFILTER_PT_bake, *seeing.CLASSES)

_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_CLASSES)


def register() -> None:
    """Registers the panels and the menu entries."""
    seeing.load_swatches()
    _register_classes()
    bpy.types.IMAGE_MT_image.append(image_editor.draw_image_menu)


def unregister() -> None:
    """Removes the menu entries and the panels."""
    bpy.types.IMAGE_MT_image.remove(image_editor.draw_image_menu)
    _unregister_classes()
    seeing.free_swatches()
