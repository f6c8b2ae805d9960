# SPDX-License-Identifier: GPL-3.0-or-later

"""What a render of a scene shows: which objects use an image, and who else reads it."""

from dataclasses import dataclass, field

import bpy

from .image_roles import has_alpha_of
from .materials import image_uses, images_of
from .users import materials_of_evaluated


@dataclass
class Viewers:
    """What shows an image.

    Attributes:
        objects: The objects whose meshes, or those that they are instancers of, use it.
        others: What shows it in a way that is no UV map on a mesh.
        alpha_covers: Whether a material shows as much of a mesh as the image's alpha says.
    """

    objects: dict[bpy.types.Object, None] = field(default_factory=dict)
    others: dict[str, None] = field(default_factory=dict)
    alpha_covers: bool = False


def viewers(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph
) -> dict[bpy.types.Image, Viewers]:
    """Returns who shows which image in renders of a scene.

    Args:
        scene: The scene, with all view layers that are rendered.
        depsgraph: The evaluated dependency graph of one of them.
    """
    found: dict[bpy.types.Image, Viewers] = {}
    objects = _rendered_objects(scene)
    # Blender makes objects of instanced geometry up while it walks over them: they go first.
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.parent.original in objects:
            _add_object(found, instance.parent.original, instance.object)
    for obj in objects:
        _add_object(found, obj, obj.evaluated_get(depsgraph))
        if obj.type == "LIGHT":
            _add_others(found, obj.data, f"the light '{obj.data.name}'")
    if scene.world is not None:
        _add_others(found, scene.world, f"the world '{scene.world.name}'")
    return found


def _rendered_objects(scene: bpy.types.Scene) -> dict[bpy.types.Object, None]:
    found: dict[bpy.types.Object, None] = {}

    def visit(layer: bpy.types.LayerCollection) -> None:
        if layer.collection.hide_render:
            return
        if not layer.exclude:
            found.update((obj, None) for obj in layer.collection.objects if not obj.hide_render)
        for child in layer.children:
            visit(child)

    for view_layer in scene.view_layers:
        if view_layer.use:
            visit(view_layer.layer_collection)
    return found


def _add_object(
    found: dict[bpy.types.Image, Viewers], owner: bpy.types.Object, shown: bpy.types.Object
) -> None:
    for material in materials_of_evaluated(shown):
        for image in images_of(material):
            entry = found.setdefault(image, Viewers())
            if shown.type == "MESH":
                entry.objects[owner] = None
                entry.others.update(dict.fromkeys(image_uses(material, image)[1]))
                entry.alpha_covers = entry.alpha_covers or has_alpha_of(material, image)
            else:
                entry.others[f"object '{owner.name}' ({shown.type.lower()}) shows it"] = None
        _add_environment(found, material, f"the material '{material.name}'")


def _add_others(
    found: dict[bpy.types.Image, Viewers],
    owner: bpy.types.World | bpy.types.Light,
    who: str,
) -> None:
    for image in images_of(owner):
        found.setdefault(image, Viewers()).others[f"{who} shows it"] = None
    _add_environment(found, owner, who)


def _add_environment(
    found: dict[bpy.types.Image, Viewers],
    owner: bpy.types.Material | bpy.types.World | bpy.types.Light,
    who: str,
) -> None:
    for image in images_of(owner, "TEX_ENVIRONMENT"):
        found.setdefault(image, Viewers()).others[f"{who} shows it as an environment"] = None
