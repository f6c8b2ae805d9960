# SPDX-License-Identifier: GPL-3.0-or-later

"""Sets the 3D view for a demonstration, and restores it afterward."""

import math

import bpy
from mathutils import Euler

_STORED_VIEW = "prefilter_view"
_HEIGHT = 3.9
"""The height of the objects with a margin, in meters."""
_SENSOR = 72.0
"""The sensor size of a 3D view: the larger side's field of view at the focal length, in
millimeters.
"""


def frame(
    context: bpy.types.Context, scene: bpy.types.Scene, width: float, *, textured: bool
) -> None:
    """Frames the demonstration in the 3D view; stores the earlier view in the scene.

    Args:
        context: The context.
        scene: The scene of the demonstration.
        width: The width of the objects, in meters.
        textured: Whether to show textures.
    """
    area = _area(context)
    if area is None:
        return
    space = area.spaces.active
    view, shading = space.region_3d, space.shading
    if _STORED_VIEW not in scene:
        scene[_STORED_VIEW] = {
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
    """Restores the 3D view of the time before the demonstration."""
    area = _area(context)
    if area is None or _STORED_VIEW not in scene:
        return
    stored = scene[_STORED_VIEW]
    space = area.spaces.active
    view = space.region_3d
    view.view_rotation, view.view_location = stored["rotation"], stored["location"]
    view.view_distance, view.view_perspective = stored["distance"], stored["perspective"]
    space.shading.type, space.shading.color_type = stored["shading"], stored["color_type"]
    area.tag_redraw()


def _covered(area: bpy.types.Area) -> tuple[int, int, int]:
    """Returns the pixels of a view that its toolbar, its sidebar and its headers cover."""
    covered = {"TOOLS": 0, "UI": 0, "HEADER": 0, "TOOL_HEADER": 0}
    window = next(region for region in area.regions if region.type == "WINDOW")
    for region in area.regions:
        overlaps = region.x < window.x + window.width and region.y < window.y + window.height
        if region.type in covered and overlaps and min(region.width, region.height) > 1:
            is_upright = region.type in {"TOOLS", "UI"}
            covered[region.type] = region.width if is_upright else region.height
    return covered["TOOLS"], covered["UI"], covered["HEADER"] + covered["TOOL_HEADER"]


def _area(context: bpy.types.Context) -> bpy.types.Area | None:
    """Returns the 3D view from which an operator was called, or the largest one."""
    if context.area is not None and context.area.type == "VIEW_3D":
        return context.area
    areas = [area for area in context.window.screen.areas if area.type == "VIEW_3D"]
    return max(areas, key=lambda area: area.width * area.height, default=None)
