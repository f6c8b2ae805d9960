# SPDX-License-Identifier: GPL-3.0-or-later

"""Objects and the images that they show in a view layer."""

from collections.abc import Iterable

import bpy

from .materials import images_of
from .meshes import images_of_objects


def shown_images(depsgraph: bpy.types.Depsgraph) -> dict[bpy.types.Image, list[bpy.types.Object]]:
    """Returns the images of visible meshes, each with its objects; see `shown_materials`."""
    by_image: dict[bpy.types.Image, dict[bpy.types.Object, None]] = {}
    images: dict[bpy.types.Material, list[bpy.types.Image]] = {}
    for owner, materials in shown_materials(depsgraph).items():
        for material in materials:
            if material not in images:
                images[material] = images_of(material)
            for image in images[material]:
                by_image.setdefault(image, {})[owner] = None
    return {image: list(owners) for image, owners in by_image.items()}


def shown_materials(
    depsgraph: bpy.types.Depsgraph,
) -> dict[bpy.types.Object, list[bpy.types.Material]]:
    """Returns visible objects with meshes, with their materials.

    Materials of an instance belong to its instancer. No mesh is evaluated.

    Args:
        depsgraph: The evaluated dependency graph.
    """
    by_object: dict[bpy.types.Object, dict[bpy.types.Material, None]] = {}
    seen = set()
    for instance in depsgraph.object_instances:
        shown = instance.object
        if shown.type != "MESH":
            continue
        owner = (instance.parent if instance.is_instance else shown).original
        key = (owner, shown.original, shown.data.as_pointer())
        if key in seen:
            continue
        seen.add(key)
        by_object.setdefault(owner, {}).update(dict.fromkeys(materials_of_evaluated(shown)))
    return {owner: list(materials) for owner, materials in by_object.items()}


def hidden_users(
    image: bpy.types.Image,
    view_layer: bpy.types.ViewLayer,
    shown: Iterable[bpy.types.Object],
) -> list[bpy.types.Object]:
    """Returns the hidden objects of a view layer that use an image.

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
    """Returns an evaluated object's materials, of its slots and of its mesh.

    Geometry nodes may set materials that are in no slot.
    """
    materials = [slot.material for slot in obj.material_slots]
    materials.extend(getattr(obj.data, "materials", ()))
    return dict.fromkeys(material.original for material in materials if material is not None)
