# SPDX-License-Identifier: GPL-3.0-or-later

"""Curve and text objects as closed contours: chains of Bezier curves, including rational ones.

Filled as in Blender: closed splines of a curve with the same material are filled together by the
even-odd rule; open splines are not filled. The contours of each letter of a text are filled by the
nonzero rule, as contours of variable fonts overlap. 3D curves, and curves with filling turned off,
are filled, too.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from . import materials
from .nurbs import bezier_segments

FloatArray = NDArray[np.float64]

CURVE_TYPES = frozenset({"CURVE", "FONT"})


@dataclass
class Fill:
    """Contours that are filled together.

    Attributes:
        contours: Homogeneous control points of Bezier curves, (segments, degree + 1, 4) per
            contour: coordinates multiplied by the weight, then the weight.
        color: Scene-linear red, green and blue, and alpha.
        fill_rule: A fill rule of `prefilter.Shape`.
    """

    contours: list[FloatArray]
    color: tuple[float, float, float, float]
    fill_rule: str


@dataclass
class Curves:
    """Filled contours of a curve or text object.

    Attributes:
        name: Name of the object.
        fills: Fills in world space, from bottom to top.
        center: Origin of the object.
        open_splines: Number of splines left out because they are open.
        problems: Other features that were left out.
    """

    name: str
    fills: list[Fill] = field(default_factory=list)
    center: FloatArray = field(default_factory=lambda: np.zeros(3))
    open_splines: int = 0
    problems: list[str] = field(default_factory=list)


def is_curve(obj: bpy.types.Object) -> bool:
    """Whether an object is a curve or a text."""
    return obj.type in CURVE_TYPES


def read_curves(
    objects: Iterable[bpy.types.Object], depsgraph: bpy.types.Depsgraph
) -> list[Curves]:
    """Copies the filled contours of curve and text objects.

    Modifiers on splines, shape keys and changes in Edit Mode are included. Hidden objects are read
    without their modifiers.

    Args:
        objects: The objects.
        depsgraph: The evaluated dependency graph.

    Raises:
        ValueError: A coordinate is not finite; the message names the object.
    """
    objects = list(objects)
    edited = [obj for obj in objects if obj.mode == "EDIT"]
    for obj in edited:
        obj.update_from_editmode()
        obj.data.update_tag()
    if edited:
        depsgraph.update()
    return [_read(obj, depsgraph) for obj in objects]


def _read(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Curves:
    curves = Curves(obj.name, problems=_ignored_features(obj))
    shown = obj.evaluated_get(depsgraph) if obj.visible_get() else obj
    matrix = np.array(shown.matrix_world, np.float64)
    curves.center = matrix[:3, 3].copy()
    colors = [materials.base_color(slot.material) for slot in obj.material_slots]
    fill_rule = "nonzero" if obj.type == "FONT" else "evenodd"
    fills: dict[tuple[int, int], Fill] = {}
    curve = shown.to_curve(depsgraph, apply_modifiers=True)
    try:
        for spline in curve.splines:
            if not spline.use_cyclic_u:
                curves.open_splines += 1
                continue
            contour = _contour(spline)
            if contour is None:
                continue
            if not np.isfinite(contour).all():
                raise ValueError(f"object '{obj.name}': a control point has no finite coordinates")
            slot = min(spline.material_index, max(len(colors) - 1, 0))
            color = colors[slot] if colors else materials.WHITE
            fill = fills.setdefault((spline.character_index, slot), Fill([], color, fill_rule))
            fill.contours.append(contour @ matrix.T)
    finally:
        shown.to_curve_clear()
    curves.fills = list(fills.values())
    return curves


def _contour(spline: bpy.types.Spline) -> FloatArray | None:
    """Control points of a closed spline in the object's space; None if it has too few points."""
    if spline.type == "BEZIER":
        return _bezier_contour(spline)
    count = len(spline.points)
    if count < 2:
        return None
    points = _numbers(spline.points, "co", 4)
    if spline.type == "POLY":
        points[:, 3] = 1.0
        return np.stack([points, np.roll(points, -1, axis=0)], axis=1)
    order = spline.order_u
    if count < order:
        return None
    points[:, :3] *= points[:, 3:]
    return bezier_segments(
        points,
        order,
        cyclic=True,
        endpoint=spline.use_endpoint_u,
        bezier=spline.use_bezier_u,
    )


def _bezier_contour(spline: bpy.types.Spline) -> FloatArray | None:
    points = spline.bezier_points
    if len(points) < 2:
        return None
    ends, left, right = (
        _numbers(points, name, 3) for name in ("co", "handle_left", "handle_right")
    )
    control = np.stack([ends, right, np.roll(left, -1, axis=0), np.roll(ends, -1, axis=0)], axis=1)
    return np.concatenate([control, np.ones((*control.shape[:2], 1))], axis=2)


def _numbers(points: bpy.types.bpy_prop_collection, name: str, width: int) -> FloatArray:
    values = np.empty(width * len(points), np.float32)
    points.foreach_get(name, values)
    return values.reshape(-1, width).astype(np.float64)


def _ignored_features(obj: bpy.types.Object) -> list[str]:
    """Names the features of an object that its contours do not have."""
    features = []
    data = obj.data
    if data.bevel_depth > 0.0 or data.bevel_object is not None or data.extrude > 0.0:
        features.append("bevel and extrusion")
    if data.offset != 0.0:
        features.append("offset")
    if any(each.show_viewport and not each.use_apply_on_spline for each in obj.modifiers):
        features.append("modifiers that are not applied on splines")
    return features
