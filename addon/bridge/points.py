# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of objects as arrays: positions, normals and attributes.

Positions are in the axes and units of the world, relative to a nearby origin, as for solids.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from .solids import MaterialKey
from .target_frame import TargetFrame

FloatArray = NDArray[np.float64]

NORMAL = "normal"
"""Attribute of normals in imported scans."""
VIEWPOINT = "scan_viewpoint"
"""Position of the scanner, in the object's own space: property of the object, or attribute of its
points if there are several."""
FROM_ABOVE = "scan_from_above"
"""Property of an object: the scanner looked down at its points."""
_COLORS = frozenset({"FLOAT_COLOR", "BYTE_COLOR"})
# The display size of points is not transferred to their surface.
_NOT_TRANSFERRED = frozenset({"radius"})


@dataclass(frozen=True)
class PointAttribute:
    """An attribute of points that is transferred to their surface.

    Attributes:
        data_type: FLOAT, FLOAT_COLOR or BYTE_COLOR.
        values: (n, 1) float32, or (n, 4) scene-linear colors.
    """

    data_type: str
    values: NDArray[np.float32]


@dataclass(frozen=True)
class Points:
    """Points of an object.

    Attributes:
        positions: (n, 3) float64.
        normals: (n, 3), of any length; None if there are none.
        attributes: Attributes by name.
        name: Name of the object.
        materials: Materials of the object's slots.
        active_color: Name of the active color attribute; empty for none.
        render_color: Name of the color attribute used by renders.
        viewpoint: Position of the scanner, (3,), or per point, (n, 3); None if it is not known.
        scan_origin: Origin of the object, the viewpoint to assume if it is not known.
        is_from_above: Whether the scanner looked down.
    """

    positions: FloatArray
    normals: NDArray[np.floating] | None = None
    attributes: dict[str, PointAttribute] = field(default_factory=dict)
    name: str = ""
    materials: tuple[MaterialKey | None, ...] = ()
    active_color: str = ""
    render_color: str = ""
    viewpoint: FloatArray | None = None
    scan_origin: FloatArray = field(default_factory=lambda: np.zeros(3))
    is_from_above: bool = False


def may_be_points(obj: bpy.types.Object) -> bool:
    """Whether an object seems to have points and no faces, without evaluating its modifiers."""
    if obj.type == "POINTCLOUD":
        return True
    if obj.type != "MESH" or len(obj.data.polygons):
        return False
    return len(obj.data.vertices) > 0 or _has_nodes(obj)


def read_points(
    objects: Iterable[bpy.types.Object], depsgraph: bpy.types.Depsgraph, origin: FloatArray
) -> list[Points]:
    """Copies the points of objects, with modifiers.

    Args:
        objects: Objects, each once; `may_be_points` is true for them.
        depsgraph: The evaluated dependency graph.
        origin: Origin of the positions.

    Returns:
        The points; two entries for an object whose nodes make a point cloud and a mesh.

    Raises:
        ValueError: Modifiers give an object faces, or its scale is 0 along an axis.
    """
    read = []
    objects = list(objects)
    for obj in objects:
        TargetFrame.of(obj, depsgraph)
        evaluated = obj.evaluated_get(depsgraph)
        if obj.type == "MESH" and evaluated.data.polygons:
            raise ValueError(
                f"object '{obj.name}': its modifiers make faces; only points can be reconstructed"
            )
        read.append(_copy(evaluated, evaluated.matrix_world, obj.name, origin))
    with_nodes = {obj for obj in objects if _has_nodes(obj)}
    for instance in depsgraph.object_instances if with_nodes else ():
        if not instance.is_instance or instance.object.type != "POINTCLOUD":
            continue
        parent = instance.parent.original
        if parent in with_nodes:
            read.append(_copy(instance.object, instance.matrix_world, parent.name, origin))
    return [points for points in read if len(points.positions)]


def _has_nodes(obj: bpy.types.Object) -> bool:
    return any(modifier.type == "NODES" for modifier in obj.modifiers)


def _copy(shown: bpy.types.Object, matrix: object, name: str, origin: FloatArray) -> Points:
    data = shown.data
    matrix_world = np.array(matrix, np.float64)
    linear, offset = matrix_world[:3, :3], matrix_world[:3, 3] - origin
    attributes = data.attributes
    local = _vectors(attributes["position"]) if "position" in attributes else np.empty((0, 3))
    with np.errstate(invalid="ignore"):  # Points that are not finite stay so.
        positions = local @ linear.T + offset
    transferred = _read_attributes(attributes)
    normals = None
    normal = attributes.get(NORMAL)
    if normal is not None and (normal.domain, normal.data_type) == ("POINT", "FLOAT_VECTOR"):
        # Normals are covectors: they transform by the inverse transpose, even if mirrored.
        with np.errstate(invalid="ignore"):
            normals = _vectors(normal) @ np.linalg.inv(linear)
    viewpoint = _viewpoint(shown)
    return Points(
        positions,
        normals,
        transferred,
        name,
        tuple(MaterialKey.of(slot.material) for slot in shown.material_slots),
        *_shown_colors(data, transferred),
        None if viewpoint is None else viewpoint @ linear.T + offset,
        offset,
        bool(shown.get(FROM_ABOVE)),
    )


def _viewpoint(shown: bpy.types.Object) -> FloatArray | None:
    """Position of the scanner, or one per point, in the object's own space; None if not known."""
    each = shown.data.attributes.get(VIEWPOINT)
    if each is not None and (each.domain, each.data_type) == ("POINT", "FLOAT_VECTOR"):
        return _vectors(each)
    try:
        viewpoint = np.array(shown.get(VIEWPOINT), np.float64)
    except (TypeError, ValueError):
        return None  # Users can set the property to anything.
    return viewpoint if viewpoint.shape == (3,) and np.isfinite(viewpoint).all() else None


def _shown_colors(data: bpy.types.ID, attributes: dict[str, PointAttribute]) -> tuple[str, str]:
    """Names of the active color attribute and of the one used by renders."""
    colors = data.color_attributes
    if isinstance(data, bpy.types.Mesh):
        index = colors.render_color_index
        return colors.active_color_name or "", colors[index].name if index >= 0 else ""
    # Point clouds have no active color attribute.
    first = next((name for name, each in attributes.items() if each.data_type in _COLORS), "")
    return first, first


def _read_attributes(attributes: Iterable[bpy.types.Attribute]) -> dict[str, PointAttribute]:
    read = {}
    for attribute in attributes:
        is_left_out = attribute.name in _NOT_TRANSFERRED or attribute.is_internal
        if attribute.domain != "POINT" or is_left_out:
            continue
        count = len(attribute.data)
        if attribute.data_type in _COLORS:
            values = np.empty((count, 4), np.float32)
            attribute.data.foreach_get("color", values.ravel())
        elif attribute.data_type == "FLOAT":
            values = np.empty((count, 1), np.float32)
            attribute.data.foreach_get("value", values.ravel())
        else:
            continue
        read[attribute.name] = PointAttribute(attribute.data_type, values)
    return read


def _vectors(attribute: bpy.types.Attribute) -> FloatArray:
    values = np.empty((len(attribute.data), 3), np.float32)
    attribute.data.foreach_get("vector", values.ravel())
    return values.astype(np.float64)
