# SPDX-License-Identifier: GPL-3.0-or-later

"""The images of a scene as panels list them, looked up again after a change."""

from dataclasses import dataclass

import bpy

from ...bridge.meshes import may_show_image
from ...core.remembered import Remembered
from ...core.targets import selected
from ...core.translations import marked, tr
from .plan import Plan, plan

_NONE = {
    (True, False): marked("No visible mesh shows an image"),
    (True, True): marked("No visible mesh shows an image of '{}'"),
    (False, False): marked("No selected mesh shows an image"),
    (False, True): marked("No selected mesh shows an image of '{}'"),
}
"""What is said where there is nothing to bake: of all visible objects or not, of a material."""


@dataclass(frozen=True)
class Known:
    """An image to bake.

    Attributes:
        image: Its name.
        content: A key of `choices.CONTENTS`.
        partner: The name of the normal map that it is the roughness of; empty for none.
    """

    image: str
    content: str
    partner: str


def _look(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> Plan:
    del scene
    return plan(depsgraph.view_layer, depsgraph)


_plans = Remembered(_look)


def images(context: bpy.types.Context, choice: str, material: str = "") -> list[Known] | None:
    """Returns the images to bake; None before a view layer is evaluated.

    Args:
        context: The context.
        choice: A key of `choices.MODEL_OBJECTS`.
        material: The name of the material whose images are baked; empty for all.
    """
    found = _plans.get(context)
    if found is None:
        return None
    chosen = chosen_objects(context, choice)
    wanted = None if chosen is None else {obj.name for obj in chosen}
    names = {item.key: item.image for item in found.items}
    return [
        Known(item.image, item.content, names.get(item.normal_map, ""))
        for item in found.items
        if (wanted is None or not wanted.isdisjoint(item.objects))
        and (not material or material in item.materials)
    ]


def chosen_objects(context: bpy.types.Context, choice: str) -> list[bpy.types.Object] | None:
    """Returns the selected objects if these are to be baked; None for all visible ones.

    Args:
        context: The context.
        choice: A key of `choices.MODEL_OBJECTS`.
    """
    if choice == "scene":
        return None
    chosen = list(selected(context))
    if choice == "auto" and not any(map(may_show_image, chosen)):
        return None
    return chosen


def why_none(context: bpy.types.Context, choice: str, material: str = "") -> str:
    """Returns why there is nothing to bake, as `images` says; empty if there is, or may be."""
    if images(context, choice, material) != []:
        return ""
    is_all = chosen_objects(context, choice) is None
    return tr(_NONE[is_all, bool(material)]).format(material)
