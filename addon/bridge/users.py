# SPDX-License-Identifier: GPL-3.0-or-later

"""Which objects show which images in a view layer."""

from collections.abc import Iterable

import bpy

from .materials import images_of
from .meshes import images_of_objects


def shown_images(depsgraph: bpy.types.Depsgraph) -> dict[bpy.types.Image, list[bpy.types.Object]]:
    """Returns the images that visible meshes show, each with the objects that show it.

    See `shown_materials`.
    """
    found: dict[bpy.types.Image, dict[bpy.types.Object, None]] = {}
    images: dict[bpy.types.Material, list[bpy.types.Image]] = {}
    for owner, materials in shown_materials(depsgraph).items():
        for material in materials:
            if material not in images:
                images[material] = images_of(material)
            for image in images[material]:
                found.setdefault(image, {})[owner] = None
    return {image: list(owners) for image, owners in found.items()}


def shown_materials(
    depsgraph: bpy.types.Depsgraph,
) -> dict[bpy.types.Object, list[bpy.types.Material]]:
    """Returns the visible objects that show meshes, with the materials of these.

    Those of an instance are shown by the object that makes it. No mesh is evaluated.

    Args:
        depsgraph: The dependency graph, evaluated before.
    """
    found: dict[bpy.types.Object, dict[bpy.types.Material, None]] = {}
    seen = set()
    for instance in depsgraph.object_instances:
        shown = instance.object
        if shown.type != "MESH":
            continue
        owner = (instance.parent if instance.is_instance else shown).original
        place = (owner, shown.original, shown.data.as_pointer())
        if place in seen:
            continue
        seen.add(place)
        found.setdefault(owner, {}).update(dict.fromkeys(materials_of_evaluated(shown)))
    return {owner: list(materials) for owner, materials in found.items()}


def hidden_users(
    image: bpy.types.Image,
    view_layer: bpy.types.ViewLayer,
    shown: Iterable[bpy.types.Object],
) -> list[bpy.types.Object]:
    """Returns the objects of a view layer that use an image, and are hidden.

    Args:
        image: The image.
        view_layer: The view layer.
        shown: The objects that show the image.
    """
    known = set(shown)
    return [
        obj
        for obj in view_layer.objects
        if obj not in known and not obj.visible_get() and image in images_of_objects([obj])
    ]


def materials_of_evaluated(obj: bpy.types.Object) -> Iterable[bpy.types.Material]:
    """Returns an evaluated object's materials; geometry nodes may set some that no slot has."""
    materials = [slot.material for slot in obj.material_slots]
    materials.extend(getattr(obj.data, "materials", ()))
    return dict.fromkeys(material.original for material in materials if material is not None)
