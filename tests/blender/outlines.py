# SPDX-License-Identifier: GPL-3.0-or-later

"""Curves and texts made in code."""

import math
from collections.abc import Sequence

import bpy
import numpy as np
import scenes

Point = tuple[float, float]

CIRCLE_HANDLE = 0.5522847498307936

# Control points and weights of a NURBS circle of radius 1, of order 3.
NURBS_CIRCLE = [
    (1, 0, 0, 1),
    (1, 1, 0, math.sqrt(0.5)),
    (0, 1, 0, 1),
    (-1, 1, 0, math.sqrt(0.5)),
    (-1, 0, 0, 1),
    (-1, -1, 0, math.sqrt(0.5)),
    (0, -1, 0, 1),
    (1, -1, 0, math.sqrt(0.5)),
]


def curve(name: str = "Curve", *, dimensions: str = "2D", select: bool = True) -> bpy.types.Object:
    """Adds a curve object without splines, and makes it the active object."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = dimensions
    return _added(name, data, select=select)


def text(body: str, name: str = "Text", *, select: bool = True) -> bpy.types.Object:
    """Adds a text object in Blender's own font, and makes it the active object."""
    data = bpy.data.curves.new(name, "FONT")
    data.body = body
    return _added(name, data, select=select)


def polygon(
    obj: bpy.types.Object, corners: Sequence[Point], *, slot: int = 0, closed: bool = True
) -> bpy.types.Spline:
    """Adds a poly spline to a curve."""
    spline = obj.data.splines.new("POLY")
    spline.points.add(len(corners) - 1)
    spline.points.foreach_set("co", np.array([(*corner, 0.0, 1.0) for corner in corners]).ravel())
    spline.use_cyclic_u = closed
    spline.material_index = slot
    return spline


def square(name: str = "Square", side: float = 1.0, at: Point = (0.0, 0.0)) -> bpy.types.Object:
    """Adds a curve object that is a square, with its lower left corner at a point."""
    obj = curve(name)
    x, y = at
    polygon(obj, [(x, y), (x + side, y), (x + side, y + side), (x, y + side)])
    return obj


def bezier_circle(obj: bpy.types.Object, radius: float = 1.0, at: Point = (0.0, 0.0)) -> None:
    """Adds a spline of four Bezier segments to a curve."""
    spline = obj.data.splines.new("BEZIER")
    spline.bezier_points.add(3)
    spline.use_cyclic_u = True
    quarter = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)], float) * radius
    along = np.roll(quarter, -1, axis=0) * CIRCLE_HANDLE
    for point, place, direction in zip(spline.bezier_points, quarter + at, along, strict=True):
        point.handle_left_type = point.handle_right_type = "FREE"
        point.co = (*place, 0.0)
        point.handle_left = (*(place - direction), 0.0)
        point.handle_right = (*(place + direction), 0.0)


def nurbs(
    obj: bpy.types.Object,
    points: Sequence[Sequence[float]],
    *,
    order: int,
    bezier: bool = False,
    endpoint: bool = False,
    closed: bool = True,
) -> bpy.types.Spline:
    """Adds a NURBS spline of (x, y, z, weight) to a curve."""
    spline = obj.data.splines.new("NURBS")
    spline.points.add(len(points) - 1)
    spline.points.foreach_set("co", np.array(points, float).ravel())
    spline.use_cyclic_u = closed
    spline.use_endpoint_u = endpoint
    spline.use_bezier_u = bezier
    spline.order_u = order
    return spline


def colored(
    obj: bpy.types.Object, *colors: Sequence[float], name: str = "Paint"
) -> list[bpy.types.Material]:
    """Gives an object materials of these base colors and alphas, a slot each."""
    made = []
    for color in colors:
        material = bpy.data.materials.new(name)
        scenes.use_nodes(material)
        material.node_tree.nodes.clear()
        shader = material.node_tree.nodes.new("ShaderNodeBsdfPrincipled")
        output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
        material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
        shader.inputs["Base Color"].default_value = (*color[:3], 1.0)
        shader.inputs["Alpha"].default_value = color[3] if len(color) > 3 else 1.0
        obj.data.materials.append(material)
        made.append(material)
    return made


def _added(name: str, data: bpy.types.Curve, *, select: bool) -> bpy.types.Object:
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    obj.select_set(select)
    bpy.context.view_layer.objects.active = obj
    return obj
