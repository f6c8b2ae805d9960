# SPDX-License-Identifier: GPL-3.0-or-later

"""The 3D view of a demonstration: what is to be seen fills it, and afterward it is as it was."""

import math

import bpy
from mathutils import Euler

_KEPT = "prefilter_view"
_HEIGHT = 3.9
"""What is to be seen, with some room."""
_SENSOR = 72.0
"""The larger side of a view is as wide as this, in millimeters, where objects are a lens away."""


def frame(
    context: bpy.types.Context, scene: bpy.types.Scene, width: float, *, textured: bool
) -> None:
    """Turns the 3D view so that it shows the demonstration; the scene keeps how it was before.

    Args:
        context: The context.
        scene: That of the demonstration.
        width: What is to be seen, in meters.
        textured: Whether images are to be seen.
    """
    area = _area(context)
    if area is None:
        return
    space = area.spaces.active
    view, shading = space.region_3d, space.shading
    if _KEPT not in scene:
        scene[_KEPT] = {
            "rotation": list(view.view_rotation),
            "location": list(view.view_location),
            "distance": view.view_distance,
            "perspective": view.view_perspective,
            "shading": shading.type,
            "color_type": shading.color_type,
        }
    shading.type = "SOLID"
    shading.color_type = "TEXTURE" if textured else "MATERIAL"
    view.view_perspective = "PERSP"
    view.view_rotation = Euler((math.radians(80.0), 0.0, 0.0)).to_quaternion()
    left, right, top = _covered(area)
    window = next(region for region in area.regions if region.type == "WINDOW")
    free = max(window.width - left - right, 1)
    across = max(width / free, _HEIGHT / max(window.height - top, 1))
    view.view_distance = across * max(window.width, window.height) * space.lens / _SENSOR
    view.view_location = (across * (right - left) / 2, 0.0, across * top / 2 - 0.2)
    area.tag_redraw()


def restore(context: bpy.types.Context, scene: bpy.types.Scene) -> None:
    """Turns the 3D view back to how it was before the demonstration."""
    area = _area(context)
    if area is None or _KEPT not in scene:
        return
    kept = scene[_KEPT]
    space = area.spaces.active
    view = space.region_3d
    view.view_rotation, view.view_location = kept["rotation"], kept["location"]
    view.view_distance, view.view_perspective = kept["distance"], kept["perspective"]
    space.shading.type, space.shading.color_type = kept["shading"], kept["color_type"]
    area.tag_redraw()


def _covered(area: bpy.types.Area) -> tuple[int, int, int]:
    """Returns how many pixels of a view its toolbar, its sidebar and its headers lie on."""
    found = {"TOOLS": 0, "UI": 0, "HEADER": 0, "TOOL_HEADER": 0}
    window = next(region for region in area.regions if region.type == "WINDOW")
    for region in area.regions:
        lies_on = region.x < window.x + window.width and region.y < window.y + window.height
        if region.type in found and lies_on and min(region.width, region.height) > 1:
            is_upright = region.type in {"TOOLS", "UI"}
            found[region.type] = region.width if is_upright else region.height
    return found["TOOLS"], found["UI"], found["HEADER"] + found["TOOL_HEADER"]


def _area(context: bpy.types.Context) -> bpy.types.Area | None:
    """Returns the 3D view that an operator was called from, or the largest one."""
    if context.area is not None and context.area.type == "VIEW_3D":
        return context.area
    areas = [area for area in context.window.screen.areas if area.type == "VIEW_3D"]
    return max(areas, key=lambda area: area.width * area.height, default=None)
