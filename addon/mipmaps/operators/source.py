"""What the operators share that read an image and its surfaces."""

from dataclasses import replace

import bpy

from ...bridge import derived, images
from ...core.operator import BackgroundOperator
from ..bake import Bake
from ..choices import Settings
from ..reading import read


class ImageOperator(BackgroundOperator):
    """A mixin: works on an image, that of the editor if none is named."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an image, and whether the operator does not run already."""
        if not super().poll(context):
            return False
        if context.area is not None and context.area.type == "IMAGE_EDITOR":
            if context.space_data.image is None:
                cls.poll_message_set("Open an image in this editor first")
                return False
        elif not bpy.data.images:
            cls.poll_message_set("There is no image in this file")
            return False
        return True


def image_to_read(
    context: bpy.types.Context, name: str, *, pictured: bool = False
) -> bpy.types.Image:
    """Returns the image of a name, or that of the editor if the name is empty.

    Args:
        context: The context.
        name: The image's name, or empty.
        pictured: Whether an image is meant where the editor shows a picture about it, such as its
            error plot.

    Raises:
        ValueError: There is no such image.
    """
    if name:
        return images.find(name)
    shown = getattr(context.space_data, "image", None)
    image = (derived.pictured(shown) if pictured else None) or shown
    if image is None:
        raise ValueError("image: no name is given, and the editor shows no image")
    return image


def selected_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Returns the objects that are selected or in Edit Mode."""
    return [obj for obj in context.view_layer.objects if obj.select_get() or obj.mode == "EDIT"]


def read_source(
    context: bpy.types.Context, name: str, settings: Settings, *, needs_surface: bool = True
) -> Bake:
    """Reads an image and the selected objects that wear it.

    Args:
        context: The context.
        name: The image's name; empty for that of the editor. Where the editor shows a picture about
            an image, such as its error plot, that image is meant.
        settings: How the image wraps, and more.
        needs_surface: Whether a surface is needed whatever the filter.

    Raises:
        ValueError: There is no such image, or no surface.
    """
    image = image_to_read(context, name, pictured=True)
    images.check_untiled(image)
    return read(
        image,
        selected_objects(context),
        replace(
            settings, use_images=True, filepath="", levels=0, roughness="", roughness_filepath=""
        ),
        context.evaluated_depsgraph_get(),
        needs_surface=needs_surface,
    )


def show_in_editor(context: bpy.types.Context, image: bpy.types.Image) -> None:
    """Shows an image in the editor that the operator was called from."""
    if context.area is not None and context.area.type == "IMAGE_EDITOR":
        context.space_data.image = image
