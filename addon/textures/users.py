# SPDX-License-Identifier: GPL-3.0-or-later

"""The objects that a bake of an image reads, with a cache for panels."""

from collections.abc import Sequence

import bpy

from ..bridge import users
from ..core.scene_cache import SceneCache
from ..core.targets import selected
from ..core.translations import tr
from ..core.wording import counted, listed
from .choices import TEXTURE_SPACE_FILTERS


def _names_of_users(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> dict[int, list[str]]:
    del scene
    shown = users.shown_images(depsgraph)
    return {image.session_uid: [obj.name for obj in objects] for image, objects in shown.items()}


_users = SceneCache(_names_of_users)
"""The names of the objects that use each image, by the image's session_uid."""


def objects_to_read(
    context: bpy.types.Context, image: bpy.types.Image, choice: str
) -> tuple[list[bpy.types.Object], list[str]]:
    """Returns the objects that a bake of an image reads, and warnings about excluded ones.

    Args:
        context: The context.
        image: The image.
        choice: A key of `choices.OBJECTS`.
    """
    if choice == "selected":
        chosen = set(selected(context))
        objects = context.view_layer.objects
        return [obj for obj in objects if obj in chosen or obj.mode == "EDIT"], []
    return users_of(image, context)


def users_of(
    image: bpy.types.Image, context: bpy.types.Context
) -> tuple[list[bpy.types.Object], list[str]]:
    """Returns the visible objects that use an image, and a warning about hidden ones."""
    shown = users.shown_images(context.evaluated_depsgraph_get()).get(image, [])
    hidden = users.hidden_users(image, context.view_layer, shown)
    names = listed(obj.name for obj in hidden)
    return shown, [f"image '{image.name}': left out, as they are hidden: {names}"] if hidden else []


def missing_reason(context: bpy.types.Context, image: bpy.types.Image, choice: str) -> str:
    """Returns why a bake has no object to read; empty if it has one, or if that is unknown."""
    if _names(context, image, choice) != []:
        return ""
    if choice == "selected":
        return tr("No selected object uses '{}'").format(image.name)
    return tr("No visible object uses '{}'").format(image.name)


def describe_inputs(
    context: bpy.types.Context, image: bpy.types.Image, choice: str, filters: Sequence[str]
) -> str:
    """Returns a summary of a bake's inputs, such as "3 objects, 2048 x 2048".

    Args:
        context: The context.
        image: The image.
        choice: A key of `choices.OBJECTS`.
        filters: Keys of `choices.FILTERS`.
    """
    if image.source == "TILED":
        parts = [tr(counted(image.tiles, "tile"))]
    else:
        parts = ["{} x {}".format(*image.size)]
    names = _names(context, image, choice)
    if names is not None and not TEXTURE_SPACE_FILTERS.issuperset(filters):
        parts.insert(0, tr(counted(names, "object")))
    return ", ".join(parts)


def _names(context: bpy.types.Context, image: bpy.types.Image, choice: str) -> list[str] | None:
    """Returns the names of the objects to read; None before a view layer is evaluated."""
    users_by_image = _users.get(context)
    if users_by_image is None:
        return None
    names = users_by_image.get(image.session_uid, [])
    if choice != "selected":
        return names
    objects = map(context.view_layer.objects.get, names)
    return [
        obj.name for obj in objects if obj is not None and (obj.select_get() or obj.mode == "EDIT")
    ]
