# SPDX-License-Identifier: GPL-3.0-or-later

"""Arrays of meshes: positions, corners, attributes and weights."""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

# Rec. 709, as in Blender's conversion of colors to numbers.
_LUMINANCE = (0.2126, 0.7152, 0.0722)
# Domains and types of attributes that can be weights.
_DOMAINS = frozenset({"POINT", "FACE", "CORNER"})
_COLOR_TYPES = frozenset({"FLOAT_COLOR", "BYTE_COLOR"})
_NUMBER_TYPES = frozenset({"FLOAT", "INT", "INT8", "BOOLEAN"})
# Attributes with a built-in meaning, which the add-on transfers separately or not at all.
_BUILT_IN = frozenset(
    {
        *("position", "material_index", "sharp_face", "sharp_edge", "custom_normal", "uv_seam"),
        *("crease_vert", "crease_edge", "bevel_weight_vert", "bevel_weight_edge"),
    }
)
# By the type of an attribute: property of its values, number of components, and their type.
_VALUES: dict[str, tuple[str, int, Any]] = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int8),
    "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT4": ("vector", 4, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
    "INT16_2D": ("value", 2, np.int16),
    "INT32_2D": ("value", 2, np.int32),
    "QUATERNION": ("value", 4, np.float32),
    "FLOAT4X4": ("value", 16, np.float32),
}


@dataclass(frozen=True)
class Weights:
    """One number for each element of a mesh.

    Attributes:
        domain: POINT, FACE or CORNER.
        values: float64.
    """

    domain: str
    values: NDArray[np.float64]


def is_free(attribute: bpy.types.Attribute) -> bool:
    """Whether an attribute is a user's, without a built-in meaning."""
    is_hidden = attribute.name.startswith(".") or attribute.is_internal
    return not (is_hidden or attribute.name in _BUILT_IN)


def is_read(attribute: bpy.types.Attribute) -> bool:
    """Whether an attribute has a type whose values can be arrays; texts cannot."""
    return attribute.data_type in _VALUES


def values_of(attribute: bpy.types.Attribute) -> NDArray[Any]:
    """Returns the values, (n, c), of an attribute for which `is_read` is true."""
    field, width, dtype = _VALUES[attribute.data_type]
    values = np.empty((len(attribute.data), width), dtype)
    attribute.data.foreach_get(field, values.ravel())
    return values


def set_values(attribute: bpy.types.Attribute, values: NDArray[Any]) -> None:
    """Sets the values of an attribute, as `values_of` returns them."""
    field, _, dtype = _VALUES[attribute.data_type]
    attribute.data.foreach_set(field, np.ascontiguousarray(values, dtype).ravel())


def positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """Returns the positions of vertices, (n, 3), in the object's space."""
    vectors = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", vectors.ravel())
    return vectors


def corner_vertices(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """Returns the vertex of each corner."""
    vertices = np.empty(len(mesh.loops), np.int32)
    mesh.attributes[".corner_vert"].data.foreach_get("value", vertices)
    return vertices


def is_triangulated(mesh: bpy.types.Mesh) -> bool:
    """Whether all faces are triangles."""
    return len(mesh.loops) == 3 * len(mesh.polygons)


def corner_triangles(
    mesh: bpy.types.Mesh,
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Triangulates faces; returns the corners of the triangles, (m, 3), and their faces."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    faces = np.empty(count, np.int32)
    mesh.loop_triangle_polygons.foreach_get("value", faces)
    return corners.reshape(-1, 3), faces


def face_materials(mesh: bpy.types.Mesh, slots: int) -> NDArray[np.int32]:
    """Returns the material slot of each face, clamped to the number of slots."""
    materials = np.zeros(len(mesh.polygons), np.int32)
    if "material_index" in mesh.attributes:
        mesh.attributes["material_index"].data.foreach_get("value", materials)
        np.clip(materials, 0, max(0, slots - 1), out=materials)
    return materials


def read_weights(
    object_name: str, mesh: bpy.types.Mesh, evaluated: bpy.types.Object | None, name: str
) -> Weights | None:
    """Returns a vertex group, or an attribute of numbers or colors, as weights.

    Args:
        object_name: Name of the object, for messages.
        mesh: The mesh.
        evaluated: Its object, which has the names of vertex groups; None for none.
        name: The name; a vertex group takes precedence over an attribute.

    Returns:
        The weights; None if there is neither.

    Raises:
        ValueError: The attribute has another domain or type.
    """
    group = evaluated.vertex_groups.get(name) if evaluated is not None else None
    if group is not None:
        return Weights("POINT", _group_weights(mesh, group.index))
    attribute = mesh.attributes.get(name)
    if attribute is None:
        return None
    subject = f"object '{object_name}', importance: attribute '{name}' is"
    if attribute.domain not in _DOMAINS:
        raise ValueError(
            f"{subject} on the domain {attribute.domain}; POINT, FACE or CORNER is needed"
        )
    if attribute.data_type in _COLOR_TYPES:
        colors = values_of(attribute)
        return Weights(attribute.domain, colors[:, :3] @ np.array(_LUMINANCE))
    if attribute.data_type not in _NUMBER_TYPES:
        raise ValueError(
            f"{subject} of the type {attribute.data_type}; a number, a color or a boolean is needed"
        )
    return Weights(attribute.domain, values_of(attribute)[:, 0].astype(np.float64))


def names_of_weights(obj: bpy.types.Object) -> list[str]:
    """Returns the names that `read_weights` accepts, for an object, evaluated or not."""
    names = [group.name for group in obj.vertex_groups]
    names += [
        attribute.name
        for attribute in obj.data.attributes
        if attribute.domain in _DOMAINS
        and attribute.data_type in _NUMBER_TYPES | _COLOR_TYPES
        and not attribute.is_internal
    ]
    return names


def group_weights(
    shown: bpy.types.Object, mesh: bpy.types.Mesh
) -> list[tuple[str, NDArray[np.float32]]]:
    """Returns the names and weights, (n,), of all vertex groups; 0 if not a member."""
    names = [group.name for group in shown.vertex_groups]
    if not names:
        return []
    weights = np.zeros((len(names), len(mesh.vertices)), np.float32)
    for i, vertex in enumerate(mesh.vertices):
        for element in vertex.groups:
            if element.group < len(names):
                weights[element.group, i] = element.weight
    return list(zip(names, weights, strict=True))


def _group_weights(mesh: bpy.types.Mesh, index: int) -> NDArray[np.float64]:
    values = np.zeros(len(mesh.vertices))
    for vertex in mesh.vertices:
        for element in vertex.groups:
            if element.group == index:
                values[vertex.index] = element.weight
    return values
