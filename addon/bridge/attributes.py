# SPDX-License-Identifier: GPL-3.0-or-later

"""Arrays of a mesh: where its vertices and corners are, and weights that a user has painted."""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

# Rec. 709, as Blender makes a number of a color.
_LUMINANCE = (0.2126, 0.7152, 0.0722)
# What weights may be.
_DOMAINS = frozenset({"POINT", "FACE", "CORNER"})
_COLOR_TYPES = frozenset({"FLOAT_COLOR", "BYTE_COLOR"})
_TYPES = {"FLOAT": np.float32, "INT": np.int32, "INT8": np.int8, "BOOLEAN": np.bool_}


@dataclass(frozen=True)
class Weights:
    """One number for each element of a mesh.

    Attributes:
        domain: POINT, FACE or CORNER.
        values: float64.
    """

    domain: str
    values: NDArray[np.float64]


def positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """Returns the vertices, (n, 3), in the object's space."""
    found = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", found.ravel())
    return found


def corner_vertices(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """Returns the vertex of each corner."""
    found = np.empty(len(mesh.loops), np.int32)
    mesh.attributes[".corner_vert"].data.foreach_get("value", found)
    return found


def is_triangulated(mesh: bpy.types.Mesh) -> bool:
    """Returns whether all faces are triangles."""
    return len(mesh.loops) == 3 * len(mesh.polygons)


def corner_triangles(
    mesh: bpy.types.Mesh,
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Returns the corners of the triangles that faces are cut into, (m, 3), and their faces."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    faces = np.empty(count, np.int32)
    mesh.loop_triangle_polygons.foreach_get("value", faces)
    return corners.reshape(-1, 3), faces


def face_materials(mesh: bpy.types.Mesh, slots: int) -> NDArray[np.int32]:
    """Returns the material slot of each face, of so many slots."""
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
        object_name: For messages.
        mesh: A mesh.
        evaluated: Its object, which knows the vertex groups; None for a mesh without an object.
        name: The name; a vertex group comes first where both have it.

    Returns:
        The weights, or None where there is neither.

    Raises:
        ValueError: The attribute has another domain or type.
    """
    group = evaluated.vertex_groups.get(name) if evaluated is not None else None
    if group is not None:
        return Weights("POINT", _group_weights(mesh, group.index))
    attribute = mesh.attributes.get(name)
    if attribute is None:
        return None
    found = f"object '{object_name}', importance: attribute '{name}' is"
    if attribute.domain not in _DOMAINS:
        raise ValueError(
            f"{found} on the domain {attribute.domain}; POINT, FACE or CORNER is needed"
        )
    count = len(attribute.data)
    if attribute.data_type in _COLOR_TYPES:
        colors = np.empty((count, 4), np.float32)
        attribute.data.foreach_get("color", colors.ravel())
        return Weights(attribute.domain, colors[:, :3] @ np.array(_LUMINANCE))
    if attribute.data_type not in _TYPES:
        raise ValueError(
            f"{found} of the type {attribute.data_type}; a number, a color or a boolean is needed"
        )
    values: NDArray[Any] = np.empty(count, _TYPES[attribute.data_type])
    attribute.data.foreach_get("value", values)
    return Weights(attribute.domain, values.astype(np.float64))


def names_of_weights(obj: bpy.types.Object) -> list[str]:
    """Returns what `read_weights` may be asked for: of an object, evaluated or not."""
    names = [group.name for group in obj.vertex_groups]
    names += [
        attribute.name
        for attribute in obj.data.attributes
        if attribute.domain in _DOMAINS
        and attribute.data_type in {*_TYPES, *_COLOR_TYPES}
        and not attribute.is_internal
    ]
    return names


def group_weights(
    shown: bpy.types.Object, mesh: bpy.types.Mesh
) -> list[tuple[str, NDArray[np.float32]]]:
    """Returns the names and the weights, (n,), of all vertex groups; 0 stands for no member."""
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
