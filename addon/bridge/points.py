# SPDX-License-Identifier: GPL-3.0-or-later

"""Objects that show points to arrays: where the points are, their normals, and what they carry.

Positions are in the axes and units of the world, from an origin that is near, as those of solids.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from .place import Place
from .solids import MaterialKey

FloatArray = NDArray[np.float64]

NORMAL = "normal"
"""The attribute that imports of scans put normals into."""
VIEWPOINT = "scan_viewpoint"
"""Where the scanner stood, in an object's own space: its property, or an attribute of its points
where that differs among them."""
FROM_ABOVE = "scan_from_above"
"""The property of an object whose points a scanner saw from above."""
_COLORS = frozenset({"FLOAT_COLOR", "BYTE_COLOR"})
# How large points are drawn is nothing for their surface.
_NOT_CARRIED = frozenset({"radius"})


@dataclass(frozen=True)
class Carried:
    """An attribute of points that their surface gets too.

    Attributes:
        data_type: FLOAT, FLOAT_COLOR or BYTE_COLOR.
        values: (n, 1) float32, or (n, 4) scene-linear colors.
    """

    data_type: str
    values: NDArray[np.float32]


@dataclass(frozen=True)
class Points:
    """Points in space.

    Attributes:
        positions: (n, 3) float64.
        normals: (n, 3), of any length; None where there are none.
        attributes: By name.
        name: What they are called.
        materials: Those of the object's slots.
        active_color: The name of the active color attribute; empty for none.
        render_color: The name of the one that renders use.
        viewpoint: Where the scanner stood, (3,), or for each point, (n, 3); None where nothing says
            that.
        scan_origin: The origin of the object, where it stood if nothing says.
        is_from_above: A scanner looked down at them.
    """

    positions: FloatArray
    normals: NDArray[np.floating] | None = None
    attributes: dict[str, Carried] = field(default_factory=dict)
    name: str = ""
    materials: tuple[MaterialKey | None, ...] = ()
    active_color: str = ""
    render_color: str = ""
    viewpoint: FloatArray | None = None
    scan_origin: FloatArray = field(default_factory=lambda: np.zeros(3))
    is_from_above: bool = False


def may_be_points(obj: bpy.types.Object) -> bool:
    """Returns whether an object has points and no faces, as far as that shows without modifiers."""
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
        origin: What positions are relative to.

    Returns:
        The points. An object whose nodes make a point cloud beside a mesh has two entries.

    Raises:
        ValueError: Modifiers give an object faces, or its scale is 0 along an axis.
    """
    found = []
    chosen = list(objects)
    for obj in chosen:
        Place.of(obj, depsgraph)
        evaluated = obj.evaluated_get(depsgraph)
        if obj.type == "MESH" and evaluated.data.polygons:
            raise ValueError(
                f"object '{obj.name}': its modifiers make faces; only points can be reconstructed"
            )
        found.append(_copied(evaluated, evaluated.matrix_world, obj.name, origin))
    with_nodes = {obj for obj in chosen if _has_nodes(obj)}
    for instance in depsgraph.object_instances if with_nodes else ():
        if not instance.is_instance or instance.object.type != "POINTCLOUD":
            continue
        parent = instance.parent.original
        if parent in with_nodes:
            found.append(_copied(instance.object, instance.matrix_world, parent.name, origin))
    return [points for points in found if len(points.positions)]


def _has_nodes(obj: bpy.types.Object) -> bool:
    return any(modifier.type == "NODES" for modifier in obj.modifiers)


def _copied(shown: bpy.types.Object, matrix: object, name: str, origin: FloatArray) -> Points:
    data = shown.data
    placed = np.array(matrix, np.float64)
    linear = placed[:3, :3]
    attributes = data.attributes
    local = _vectors(attributes["position"]) if "position" in attributes else np.empty((0, 3))
    with np.errstate(invalid="ignore"):  # Points that are not finite stay so.
        positions = local @ linear.T + (placed[:3, 3] - origin)
    carried = _carried(attributes)
    normals = None
    normal = attributes.get(NORMAL)
    if normal is not None and (normal.domain, normal.data_type) == ("POINT", "FLOAT_VECTOR"):
        # Normals are covectors: they go with the inverse transpose, mirrored or not.
        with np.errstate(invalid="ignore"):
            normals = _vectors(normal) @ np.linalg.inv(linear)
    viewpoint = _viewpoint(shown)
    return Points(
        positions,
        normals,
        carried,
        name,
        tuple(MaterialKey.of(slot.material) for slot in shown.material_slots),
        *_shown_colors(data, carried),
        None if viewpoint is None else viewpoint @ linear.T + (placed[:3, 3] - origin),
        placed[:3, 3] - origin,
        bool(shown.get(FROM_ABOVE)),
    )


def _viewpoint(shown: bpy.types.Object) -> FloatArray | None:
    """Returns where the scanner stood, in the object's own space."""
    each = shown.data.attributes.get(VIEWPOINT)
    if each is not None and (each.domain, each.data_type) == ("POINT", "FLOAT_VECTOR"):
        return _vectors(each)
    own = shown.get(VIEWPOINT)
    try:
        found = np.array(own, np.float64)
    except (TypeError, ValueError):
        return None  # a user may set the property to anything
    return found if found.shape == (3,) and np.isfinite(found).all() else None


def _shown_colors(data: bpy.types.ID, carried: dict[str, Carried]) -> tuple[str, str]:
    """Returns the names of the active color attribute and of the one that renders use."""
    colors = data.color_attributes
    if isinstance(data, bpy.types.Mesh):
        index = colors.render_color_index
        return colors.active_color_name or "", colors[index].name if index >= 0 else ""
    # Point clouds have colors, but none of them is active.
    first = next((name for name, one in carried.items() if one.data_type in _COLORS), "")
    return first, first


def _carried(attributes: Iterable[bpy.types.Attribute]) -> dict[str, Carried]:
    found = {}
    for attribute in attributes:
        if attribute.domain != "POINT" or attribute.name in _NOT_CARRIED or attribute.is_internal:
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
        found[attribute.name] = Carried(attribute.data_type, values)
    return found


def _vectors(attribute: bpy.types.Attribute) -> FloatArray:
    values = np.empty((len(attribute.data), 3), np.float32)
    attribute.data.foreach_get("vector", values.ravel())
    return values.astype(np.float64)
