# SPDX-License-Identifier: GPL-3.0-or-later

"""Attributes of meshes, by triangle corners, for transfer between meshes."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import attributes

COLOR = "COLOR"
UV_MAP = "UV_MAP"
ATTRIBUTE = "ATTRIBUTE"
VERTEX_GROUP = "VERTEX_GROUP"
NORMALS = "NORMALS"
FREESTYLE = "FREESTYLE"
"""Faces marked for Freestyle, in Blender versions without an attribute for that."""
SHADED_KEY = "prefilter_shaded"
"""Tags meshes with computed custom normals, which are not transferred."""

_FREESTYLE_PROPERTY = "use_freestyle_mark"
_DOMAINS = ("POINT", "CORNER", "FACE")
_ROTATIONS = frozenset({"QUATERNION", "FLOAT4X4"})
FACE_SETS = ".sculpt_face_set"
_SCULPTED = frozenset({".sculpt_mask", FACE_SETS})
"""Attributes of Sculpt Mode."""


@dataclass(frozen=True)
class Layer:
    """Values of a mesh, indexed by the corners of its triangles.

    Attributes:
        kind: COLOR, UV_MAP, ATTRIBUTE, VERTEX_GROUP, NORMALS or FREESTYLE.
        name: Name of the attribute; empty for NORMALS and FREESTYLE.
        data_type: Blender's name of the attribute type.
        domain: POINT, CORNER or FACE.
        values: (k, c).
        corners: Indices of values per corner, (m, 3) int32, for POINT and CORNER; per triangle,
            (m, 1), for FACE.
    """

    kind: str
    name: str
    data_type: str
    domain: str
    values: NDArray[Any]
    corners: NDArray[np.int32]

    @property
    def key(self) -> tuple[str, str]:
        """Kind and name; layers of several meshes with the same key are joined."""
        return self.kind, self.name

    @property
    def is_blended(self) -> bool:
        """Whether values can be averaged; rotations and matrices cannot."""
        return self.values.dtype.kind == "f" and self.data_type not in _ROTATIONS

    def reversed(self) -> "Layer":
        """Returns the layer for triangles with reversed orientation."""
        return self if self.domain == "FACE" else replace(self, corners=self.corners[:, ::-1])

    def rotated(self, linear: NDArray[np.float64]) -> "Layer":
        """Returns the layer after a linear transform of the mesh, which rotates normals."""
        if self.kind != NORMALS:
            return self
        normals = self.values @ np.linalg.inv(linear)
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        return replace(self, values=(normals / np.maximum(lengths, 1e-30)).astype(np.float32))


@dataclass(frozen=True)
class NewLayer:
    """Values of a new mesh: one for each vertex, corner or face.

    Attributes:
        kind: As for `Layer`.
        name: As for `Layer`.
        data_type: As for `Layer`.
        domain: As for `Layer`.
        values: (k, c), one row per element of the domain.
    """

    kind: str
    name: str
    data_type: str
    domain: str
    values: NDArray[Any]


@dataclass(frozen=True)
class LayerSelection:
    """Kinds of layers to read.

    Attributes:
        colors: Color attributes.
        uv_maps: UV maps.
        attributes: Vertex groups, custom normals and all other attributes.
    """

    colors: bool = True
    uv_maps: bool = True
    attributes: bool = True


@dataclass(frozen=True)
class Triangles:
    """Vertices, corners and faces of the triangles of an evaluated mesh.

    Attributes:
        vertices: (m, 3).
        corners: (m, 3); None if all faces are triangles.
        faces: (m,); None if all faces are triangles.
    """

    vertices: NDArray[np.int32]
    corners: NDArray[np.int32] | None = None
    faces: NDArray[np.int32] | None = None

    def indices(self, domain: str) -> NDArray[np.int32]:
        """Indices of the triangles' values in a domain: (m, 3), for faces (m, 1)."""
        count = len(self.vertices)
        if domain == "POINT":
            return self.vertices
        if domain == "FACE":
            faces = np.arange(count, dtype=np.int32) if self.faces is None else self.faces
            return faces[:, None]
        if self.corners is None:
            return np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
        return self.corners


def read_layers(
    shown: bpy.types.Object, mesh: bpy.types.Mesh, triangles: Triangles, selection: LayerSelection
) -> Iterator[Layer]:
    """Yields the layers of an evaluated mesh.

    Args:
        shown: The object of the mesh, which has the names of vertex groups.
        mesh: The mesh.
        triangles: Its triangles.
        selection: Layers to read.
    """
    indices = cache(triangles.indices)
    yield from _read_attributes(mesh, indices, selection)
    if not selection.attributes:
        return
    if _FREESTYLE_PROPERTY in bpy.types.MeshPolygon.bl_rna.properties:
        flags = np.empty((len(mesh.polygons), 1), np.bool_)
        mesh.polygons.foreach_get(_FREESTYLE_PROPERTY, flags.ravel())
        if flags.any():
            yield Layer(FREESTYLE, "", "BOOLEAN", "FACE", flags, indices("FACE"))
    for name, values in attributes.group_weights(shown, mesh):
        yield Layer(VERTEX_GROUP, name, "FLOAT", "POINT", values[:, None], triangles.vertices)
    if mesh.has_custom_normals and SHADED_KEY not in shown.original.data:
        normals = np.empty((len(mesh.loops), 3), np.float32)
        mesh.corner_normals.foreach_get("vector", normals.ravel())
        yield Layer(NORMALS, "", "FLOAT_VECTOR", "CORNER", normals, indices("CORNER"))


def _read_attributes(
    mesh: bpy.types.Mesh, indices: Callable[[str], NDArray[np.int32]], selection: LayerSelection
) -> Iterator[Layer]:
    uv_maps = {layer.name for layer in mesh.uv_layers}
    colors = {layer.name for layer in mesh.color_attributes}
    for attribute in mesh.attributes:
        kind = COLOR if attribute.name in colors else ATTRIBUTE
        if attribute.name in uv_maps:
            kind = UV_MAP
        is_selected = {
            COLOR: selection.colors,
            UV_MAP: selection.uv_maps,
            ATTRIBUTE: selection.attributes and _is_transferable(attribute),
        }
        domain = attribute.domain
        if is_selected[kind] and domain in _DOMAINS and attributes.is_read(attribute):
            values = attributes.values_of(attribute)
            yield Layer(kind, attribute.name, attribute.data_type, domain, values, indices(domain))


def write_layer(mesh: bpy.types.Mesh, layer: NewLayer) -> None:
    """Adds a color attribute, a UV map or another attribute to a mesh, or sets Freestyle marks."""
    if layer.kind == FREESTYLE:
        mesh.polygons.foreach_set(_FREESTYLE_PROPERTY, layer.values[:, 0])
        return
    if layer.kind == UV_MAP:
        # In some versions a new UV attribute does not become a UV map by itself.
        uv_map = mesh.uv_layers.new(name=layer.name, do_init=False)
        attribute = mesh.attributes[uv_map.name]
    else:
        attribute = mesh.attributes.new(layer.name, layer.data_type, layer.domain)
    attributes.set_values(attribute, layer.values)


def unread(mesh: bpy.types.Mesh) -> set[str]:
    """Returns the names of a user's attributes whose types cannot be transferred."""
    return {
        attribute.name
        for attribute in mesh.attributes
        if attributes.is_free(attribute) and not attributes.is_read(attribute)
    }


def _is_transferable(attribute: bpy.types.Attribute) -> bool:
    return attribute.name in _SCULPTED or attributes.is_free(attribute)
