# SPDX-License-Identifier: GPL-3.0-or-later

"""The images of a scene that can be baked, cached for panels."""

from dataclasses import dataclass

import bpy

from ...bridge.meshes import may_show_image
from ...core.scene_cache import SceneCache
from ...core.targets import selected
from ...core.translations import marked, tr
from .plan import Plan, plan

_NONE = {
    (True, False): marked("No visible mesh shows an image"),
    (True, True): marked("No visible mesh shows an image of '{}'"),
    (False, False): marked("No selected mesh shows an image"),
    (False, True): marked("No selected mesh shows an image of '{}'"),
}
"""Messages if there is nothing to bake, by whether all visible objects and a material are meant."""


@dataclass(frozen=True)
class Candidate:
    """An image to bake.

    Attributes:
        image: Its name.
        content: A key of `choices.CONTENTS`.
        partner: The name of the normal map that belongs to this roughness; empty for none.
    """

    image: str
    content: str
    partner: str


def _plan(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> Plan:
    del scene
    return plan(depsgraph.view_layer, depsgraph)


_plans = SceneCache(_plan)


def candidates(
    context: bpy.types.Context, choice: str, material: str = ""
) -> list[Candidate] | None:
    """Returns the images to bake; None before a view layer is evaluated.

    Args:
        context: The context.
        choice: A key of `choices.MODEL_OBJECTS`.
        material: The name of the material whose images are baked; empty for all.
    """
    scene_plan = _plans.get(context)
    if scene_plan is None:
        return None
    objects = chosen_objects(context, choice)
    chosen = None if objects is None else {obj.name for obj in objects}
    names = {item.key: item.image for item in scene_plan.items}
    return [
        Candidate(item.image, item.content, names.get(item.normal_map, ""))
        for item in scene_plan.items
        if (chosen is None or not chosen.isdisjoint(item.objects))
        and (not material or material in item.materials)
    ]


def chosen_objects(context: bpy.types.Context, choice: str) -> list[bpy.types.Object] | None:
    """Returns the selected objects if the bake is limited to them; None for all visible ones.

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


def missing_reason(context: bpy.types.Context, choice: str, material: str = "") -> str:
    """Returns why there is nothing to bake; empty if there is something, or if that is unknown."""
    if candidates(context, choice, material) != []:
        return ""
    is_all = chosen_objects(context, choice) is None
    return tr(_NONE[is_all, bool(material)]).format(material)
