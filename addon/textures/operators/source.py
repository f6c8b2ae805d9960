# SPDX-License-Identifier: GPL-3.0-or-later

"""Mixins and functions of operators that read an image and its surfaces."""

from collections.abc import Generator
from dataclasses import replace
from typing import TYPE_CHECKING

import bpy

from ...bridge.image_operator import ImageOperator
from ...core.operator import BackgroundOperator
from ...core.operator_hooks import run_steps
from ...core.wording import Sentence
from ..choices import Settings

if TYPE_CHECKING:
    from ..source import Source


class PictureOperator(ImageOperator):
    """A mixin for operators on an image, even if the editor shows a picture made from it."""

    @classmethod
    def shown_image(cls, context: bpy.types.Context) -> bpy.types.Image | None:
        """Returns the image of the editor, see `shown_image`."""
        return shown_image(context)

    def chosen_image(self, context: bpy.types.Context) -> bpy.types.Image:
        """Returns the image to work on, see `image_to_read`."""
        return image_to_read(context, self.image)


class SurfaceOperator(PictureOperator, BackgroundOperator):
    """A mixin for operators on an image and its surfaces."""

    @classmethod
    def reads_surface(cls, context: bpy.types.Context) -> bool:
        """Returns whether a surface is needed, with the settings of the panels."""
        del context
        return True

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether there is an image, with a surface if one is needed."""
        from .. import users

        if cls.may_be_redone(context):
            return True
        if not super().poll(context):
            return False
        is_editor = context.area is not None and context.area.type == "IMAGE_EDITOR"
        if is_editor and cls.reads_surface(context):
            image = cls.shown_image(context)
            reason = users.missing_reason(context, image, context.scene.prefilter_bake.objects)
            if reason:
                cls.poll_message_set(reason)
                return False
        return True


def shown_image(context: bpy.types.Context) -> bpy.types.Image | None:
    """Returns the image of the editor; for a picture such as an error plot, its source image."""
    from ...bridge import derived

    shown = getattr(context.space_data, "image", None)
    return derived.pictured(shown) or shown


def image_to_read(context: bpy.types.Context, name: str) -> bpy.types.Image:
    """Returns the image with a name; for an empty name, that of the editor or the active object.

    Raises:
        ValueError: There is no such image.
    """
    from ...bridge import images

    if name:
        return images.find(name)
    image = shown_image(context) or _image_of(context.active_object)
    if image is None:
        raise ValueError(
            Sentence(
                "image: no name is given, the editor shows no image, and the active object has no "
                "single base color image"
            )
        )
    return image


def read_source(context: bpy.types.Context, name: str, settings: Settings) -> "Source":
    """Runs `read_source_steps` to its end."""
    return run_steps(read_source_steps(context, name, settings))


def read_source_steps(
    context: bpy.types.Context, name: str, settings: Settings, *, needs_surface: bool = True
) -> "Generator[float, None, Source]":
    """Reads an image and the objects that use it, one frame per step.

    Args:
        context: The context.
        name: The image's name; empty for the default of `image_to_read`.
        settings: The settings of the bake.
        needs_surface: Whether a surface is required even if the filter needs none.

    Yields:
        The fraction done.

    Raises:
        ValueError: There is no such image, or no surface.
    """
    from prefilter.workflows.textures import lookups

    from ...bridge import images
    from .. import bake_inputs, users
    from ..bake import Bake
    from ..bake_inputs import Request

    image = image_to_read(context, name)
    images.check_untiled(image)
    objects, warnings = users.objects_to_read(context, image, settings.objects)
    request = Request(
        image,
        objects,
        replace(
            lookups.resolved(settings),
            use_images=True,
            filepath="",
            levels=0,
            roughness="",
            roughness_filepath="",
        ),
        context.evaluated_depsgraph_get(),
        needs_surface=needs_surface,
    )
    bake = yield from bake_inputs.read_steps(request)
    assert isinstance(bake, Bake)
    bake.warnings.extend(warnings)
    return bake.source


def _image_of(obj: bpy.types.Object | None) -> bpy.types.Image | None:
    """Returns the base color of an object's active material, or its only image."""
    from ...bridge import image_roles, materials

    material = obj.active_material if obj is not None else None
    if material is None:
        return None
    images = materials.images_of(material)
    colors = [image for image in images if image_roles.has_base_color_of(material, image)]
    return next(iter(colors or images)) if len(colors or images) == 1 else None
