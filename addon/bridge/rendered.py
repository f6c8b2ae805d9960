# SPDX-License-Identifier: GPL-3.0-or-later

"""Users of images in renders of a scene: meshes, worlds, lights and others."""

from dataclasses import dataclass, field

import bpy

from .image_roles import has_alpha_of
from .materials import image_uses, images_of
from .users import materials_of_evaluated


@dataclass
class Viewers:
    """Users of an image in a render.

    Attributes:
        objects: Objects whose meshes or instanced meshes use it.
        others: Descriptions of other uses, without a UV map on a mesh.
        alpha_covers: Whether a material uses the image's alpha as coverage.
    """

    objects: dict[bpy.types.Object, None] = field(default_factory=dict)
    others: dict[str, None] = field(default_factory=dict)
    alpha_covers: bool = False


def viewers(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph
) -> dict[bpy.types.Image, Viewers]:
    """Returns the users of each image in renders of a scene.

    Args:
        scene: The scene; all its rendered view layers count.
        depsgraph: The evaluated dependency graph of one of them.
    """
    users: dict[bpy.types.Image, Viewers] = {}
    objects = _rendered_objects(scene)
    # The objects of instanced geometry exist only during this iteration.
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.parent.original in objects:
            _add_object(users, instance.parent.original, instance.object)
    for obj in objects:
        _add_object(users, obj, obj.evaluated_get(depsgraph))
        if obj.type == "LIGHT":
            _add_others(users, obj.data, f"the light '{obj.data.name}'")
    if scene.world is not None:
        _add_others(users, scene.world, f"the world '{scene.world.name}'")
    return users


def _rendered_objects(scene: bpy.types.Scene) -> dict[bpy.types.Object, None]:
    objects: dict[bpy.types.Object, None] = {}

    def visit(layer: bpy.types.LayerCollection) -> None:
        if layer.collection.hide_render:
            return
        if not layer.exclude:
            objects.update((obj, None) for obj in layer.collection.objects if not obj.hide_render)
        for child in layer.children:
            visit(child)

    for view_layer in scene.view_layers:
        if view_layer.use:
            visit(view_layer.layer_collection)
    return objects


def _add_object(
    users: dict[bpy.types.Image, Viewers], owner: bpy.types.Object, shown: bpy.types.Object
) -> None:
    for material in materials_of_evaluated(shown):
        for image in images_of(material):
            entry = users.setdefault(image, Viewers())
            if shown.type == "MESH":
                entry.objects[owner] = None
                entry.others.update(dict.fromkeys(image_uses(material, image)[1]))
                entry.alpha_covers = entry.alpha_covers or has_alpha_of(material, image)
            else:
                entry.others[f"object '{owner.name}' ({shown.type.lower()}) shows it"] = None
        _add_environment(users, material, f"the material '{material.name}'")


def _add_others(
    users: dict[bpy.types.Image, Viewers],
    owner: bpy.types.World | bpy.types.Light,
    who: str,
) -> None:
    for image in images_of(owner):
        users.setdefault(image, Viewers()).others[f"{who} shows it"] = None
    _add_environment(users, owner, who)


def _add_environment(
    users: dict[bpy.types.Image, Viewers],
    owner: bpy.types.Material | bpy.types.World | bpy.types.Light,
    who: str,
) -> None:
    for image in images_of(owner, "TEX_ENVIRONMENT"):
        users.setdefault(image, Viewers()).others[f"{who} shows it as an environment"] = None
