# SPDX-License-Identifier: GPL-3.0-or-later

"""The images of a scene as panels list them, looked up again after a change."""

from dataclasses import dataclass

import bpy

from ...core.remembered import Remembered
from .plan import Item, Plan, plan


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
    names = {item.full_name: item.image for item in found.items}
    return [
        Known(item.image, item.content, names.get(item.normal_map, ""))
        for item in found.items
        if (choice == "scene" or _is_selected(context, item))
        and (not material or material in item.materials)
    ]


def _is_selected(context: bpy.types.Context, item: Item) -> bool:
    objects = map(context.view_layer.objects.get, item.objects)
    return any(obj is not None and obj.select_get() for obj in objects)


def why_none(context: bpy.types.Context, choice: str, material: str = "") -> str:
    """Returns why there is nothing to bake, as `images` says; empty if there is, or may be."""
    if images(context, choice, material) != []:
        return ""
    shown = f"an image of '{material}'" if material else "an image"
    return f"No {'selected' if choice == 'selected' else 'visible'} mesh shows {shown}"
