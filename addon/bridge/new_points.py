# SPDX-License-Identifier: GPL-3.0-or-later

"""New objects of points: point clouds, or meshes without faces."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from .color_materials import show_attribute
from .layers import COLOR, NewLayer, write_layer
from .points import FROM_ABOVE, NORMAL, VIEWPOINT

OFFSET = "scan_offset"
"""Property of an object: offset that was subtracted from its points to move them to the origin."""
_MAX_DISTANCE_EXTENTS = 100.0
"""Distance from the origin, in extents of the points, above which they are moved to the origin. At
this distance the steps of single precision are a fortieth of the smallest cells."""
_MARK = "prefilter_draws_points"
_RADIUS = "radius"
_BUILT_IN = frozenset({"position", "id", NORMAL, VIEWPOINT, _RADIUS})


@dataclass(frozen=True)
class Cloud:
    """Points for a new object.

    Attributes:
        name: Name of the object.
        positions: (n, 3) float64, finite.
        normals: (n, 3); None if there are none.
        layers: Its attributes, of the domain POINT.
        viewpoint: Position of the scanner, (3,), or per point, (n, 3); None if it is not known.
        is_from_above: Whether the scanner looked down.
    """

    name: str
    positions: NDArray[np.float64]
    normals: NDArray[np.floating] | None
    layers: Sequence[NewLayer]
    viewpoint: NDArray[np.float64] | None = None
    is_from_above: bool = False

    @property
    def color(self) -> str:
        """Name of the first color attribute; empty for none."""
        return next((layer.name for layer in self.layers if layer.kind == COLOR), "")


def far_offset(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rounded center of points that are far from the origin; zero for others.

    It is rounded to the order of magnitude of the points' extent.
    """
    low, high = positions.min(axis=0), positions.max(axis=0)
    center = (low + high) / 2
    extent = float((high - low).max())
    if not float(np.abs(center).max()) > _MAX_DISTANCE_EXTENTS * extent:
        return np.zeros(3)
    step = 10.0 ** max(math.floor(math.log10(extent)), 0) if extent > 0.0 else 1.0
    return np.asarray(np.round(center / step) * step)


def kept_offset(obj: bpy.types.Object) -> NDArray[np.float64]:
    """Offset that was subtracted from an object's points; zero if none was."""
    try:
        offset = np.array(obj.get(OFFSET, (0.0, 0.0, 0.0)), np.float64)
    except (TypeError, ValueError):
        return np.zeros(3)  # Users can set the property to anything.
    return offset if offset.shape == (3,) and np.isfinite(offset).all() else np.zeros(3)


def shown_offset(offset: NDArray[np.float64]) -> str:
    """Formats an offset for users."""
    return ", ".join(f"{value:.0f}" for value in offset)


def scene_offset(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the offset of an object of the scene if it suits the points, or else `far_offset`."""
    offset = far_offset(positions)
    if offset.any():
        for obj in bpy.context.scene.objects:
            other = kept_offset(obj)
            if other.any() and not far_offset(positions - other).any():
                return other
    return offset


def new_points(cloud: Cloud, offset: NDArray[np.float64]) -> bpy.types.Object:
    """Makes an object of points in the active collection.

    Args:
        cloud: The points.
        offset: Subtracted from their positions, and stored as a property of the object.
    """
    local = (cloud.positions - offset).astype(np.float32)
    if "resize" in bpy.types.PointCloud.bl_rna.functions:
        data = bpy.data.pointclouds.new(cloud.name)
        data.resize(len(local))
        radius = data.attributes.new(_RADIUS, "FLOAT", "POINT").data
        radius.foreach_set("value", np.full(len(local), spacing(local) / 2, np.float32))
    else:
        # Before Blender 5.0, Python cannot make point clouds.
        data = bpy.data.meshes.new(cloud.name)
        data.vertices.add(len(local))
    data.attributes["position"].data.foreach_set("vector", local.ravel())
    if cloud.normals is not None:
        _write_vectors(data, NORMAL, cloud.normals)
    if cloud.viewpoint is not None and cloud.viewpoint.ndim == 2:
        _write_vectors(data, VIEWPOINT, cloud.viewpoint - offset)
    for layer in cloud.layers:
        write_layer(data, layer)
    data.update_tag()
    show_attribute(data, cloud.color)
    obj = bpy.data.objects.new(cloud.name, data)
    if cloud.color and isinstance(data, bpy.types.Mesh):
        data.color_attributes.active_color_name = cloud.color
        data.color_attributes.render_color_index = data.color_attributes.find(cloud.color)
        _draw_points(obj, spacing(local) / 2)
    if offset.any():
        obj[OFFSET] = offset.tolist()
    if cloud.viewpoint is not None and cloud.viewpoint.ndim == 1:
        obj[VIEWPOINT] = (cloud.viewpoint - offset).tolist()
    if cloud.is_from_above:
        obj[FROM_ABOVE] = True
    bpy.context.collection.objects.link(obj)
    return obj


def _write_vectors(data: bpy.types.ID, name: str, vectors: NDArray[np.floating]) -> None:
    attribute = data.attributes.new(name, "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.ascontiguousarray(vectors, np.float32).ravel())


def layer_name(name: str) -> str:
    """Changes the name of a file's attribute if it means something else in Blender."""
    name = name.lstrip(".") or "value"
    return f"{name}_value" if name in _BUILT_IN else name


def spacing(positions: NDArray[np.floating]) -> float:
    """Estimates the point spacing, as if points covered half the box around most of them."""
    low, high = np.quantile(positions[:: len(positions) // 100_000 + 1], (0.02, 0.98), axis=0)
    a, b, c = (float(side) for side in high - low)
    return float(np.sqrt((a * b + b * c + c * a) / len(positions)))


def _draw_points(obj: bpy.types.Object, radius: float) -> None:
    """Adds a modifier that draws vertices as balls in the colors of the material."""
    group = _drawing_nodes()
    modifier = obj.modifiers.new(group.name, "NODES")
    modifier.node_group = group
    values = {"Radius": radius, "Material": obj.data.materials[0]}
    for socket in group.interface.items_tree:
        if socket.in_out == "INPUT" and socket.name in values:
            modifier[socket.identifier] = values[socket.name]


def _drawing_nodes() -> bpy.types.NodeTree:
    """Returns the node group that draws vertices as a point cloud; made if missing."""
    for group in bpy.data.node_groups:
        if group.library is None and group.get(_MARK):
            return group
    group = bpy.data.node_groups.new("Points as Balls", "GeometryNodeTree")
    group[_MARK] = True
    sockets = {"Geometry": "Geometry", "Radius": "Float", "Material": "Material"}
    for name, kind in sockets.items():
        group.interface.new_socket(name, in_out="INPUT", socket_type=f"NodeSocket{kind}")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    kinds = ("NodeGroupInput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial")
    start, balls, painted, end = (group.nodes.new(kind) for kind in (*kinds, "NodeGroupOutput"))
    for i, node in enumerate((start, balls, painted, end)):
        node.location = (200 * i, 0)
    group.links.new(start.outputs["Geometry"], balls.inputs["Mesh"])
    group.links.new(start.outputs["Radius"], balls.inputs["Radius"])
    group.links.new(balls.outputs["Points"], painted.inputs["Geometry"])
    group.links.new(start.outputs["Material"], painted.inputs["Material"])
    group.links.new(painted.outputs["Geometry"], end.inputs["Geometry"])
    return group
