# SPDX-License-Identifier: GPL-3.0-or-later

"""Solids joined into one mesh, with the layers and materials of all parts."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..bridge.layers import COLOR, FACE_SETS, NORMALS, UV_MAP, Layer
from ..bridge.solids import Part, Positions

IntArray = NDArray[np.int32]


@dataclass(frozen=True)
class OwnMesh:
    """The part of a joined mesh that is the object's own, without instances; it comes first.

    Attributes:
        vertices: Number of vertices.
        triangles: Number of triangles.
        faces: Face of each triangle; None if all faces are triangles.
    """

    vertices: int
    triangles: int
    faces: IntArray | None

    def faces_of(self, triangles: NDArray[np.integer]) -> IntArray:
        """Own faces of triangles of the joined mesh, each once, ascending."""
        own = triangles[triangles < self.triangles]
        return np.unique(own if self.faces is None else self.faces[own]).astype(np.int32)


@dataclass(frozen=True)
class SolidMesh:
    """The parts of solids as one mesh.

    Attributes:
        positions: (n, 3), float32 or float64.
        triangles: (m, 3) int32, counter-clockwise from outside.
        materials: (m,) int32, or (1,) if all triangles have the same.
        layers: Its attributes; parts that lack one have white or 0 there.
        own: The object's own part, if there is one.
    """

    positions: Positions
    triangles: IntArray
    materials: IntArray
    layers: list[Layer] = field(default_factory=list)
    own: "OwnMesh | None" = None

    @property
    def has_several_materials(self) -> bool:
        """Whether triangles have different materials."""
        return len(self.materials) > 1

    @property
    def uvs(self) -> list[NDArray[np.float32]]:
        """UVs of the triangles' corners, (m, 3, 2), per map."""
        return [layer.values[layer.corners] for layer in self.layers if layer.kind == UV_MAP]

    def material_of(self, triangles: NDArray[np.integer]) -> IntArray:
        """Materials of triangles."""
        if self.has_several_materials:
            return self.materials[triangles]
        return np.full(len(triangles), self.materials[0], np.int32)


def solid_mesh(parts: list[Part]) -> SolidMesh:
    """Joins the parts of a solid."""
    mesh = join(
        [SolidMesh(part.positions, part.triangles, part.materials, part.layers) for part in parts]
    )
    first = parts[0]
    if not first.is_own:
        return mesh
    own = OwnMesh(len(first.positions), len(first.triangles), first.faces)
    return replace(mesh, own=own)


def join(meshes: list[SolidMesh]) -> SolidMesh:
    """Joins meshes."""
    if len(meshes) == 1:
        return meshes[0]
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    materials = np.concatenate(
        [mesh.material_of(np.arange(len(mesh.triangles))) for mesh in meshes]
    )
    return SolidMesh(
        np.concatenate([mesh.positions for mesh in meshes]),
        np.concatenate(
            [mesh.triangles + start for mesh, start in zip(meshes, starts[:-1], strict=True)]
        ).astype(np.int32),
        materials if (materials != materials[0]).any() else materials[:1],
        _joined_layers(meshes),
    )


def _joined_layers(meshes: list[SolidMesh]) -> list[Layer]:
    """Joins layers by kind and name, if they have the same type and domain."""
    firsts: dict[tuple[str, str], Layer] = {}
    for mesh in meshes:
        for layer in mesh.layers:
            firsts.setdefault(layer.key, layer)
    return [_joined_layer(first, meshes) for first in firsts.values()]


def _joined_layer(first: Layer, meshes: list[SolidMesh]) -> Layer:
    values: list[NDArray[Any]] = []
    corners = []
    start = 0
    for mesh in meshes:
        layer = next((each for each in mesh.layers if _are_alike(each, first)), None)
        if layer is None:
            layer = _default_layer(first, mesh)
        values.append(layer.values)
        corners.append(layer.corners + start)
        start += len(layer.values)
    return replace(
        first, values=np.concatenate(values), corners=np.concatenate(corners).astype(np.int32)
    )


def _are_alike(layer: Layer, other: Layer) -> bool:
    if layer.key != other.key or layer.values.dtype != other.values.dtype:
        return False
    width, faces = layer.values.shape[1], layer.domain == "FACE"
    return width == other.values.shape[1] and faces == (other.domain == "FACE")


def _default_layer(first: Layer, mesh: SolidMesh) -> Layer:
    """Layer for a mesh that lacks it: white, face normals, identity rotations, set 1, or 0."""
    width = 1 if first.domain == "FACE" else 3
    if first.kind == NORMALS:
        a, b, c = np.moveaxis(mesh.positions[mesh.triangles], 1, 0)
        normals = np.cross(b - a, c - a)
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        values = (normals / np.maximum(lengths, 1e-30)).astype(np.float32)
        corners = np.repeat(np.arange(len(values), dtype=np.int32)[:, None], 3, axis=1)
        return replace(first, values=values, corners=corners)
    fill = 1 if first.kind == COLOR or first.name == FACE_SETS else 0
    values = np.full((1, first.values.shape[1]), fill, first.values.dtype)
    if first.data_type == "QUATERNION":
        values[0, 0] = 1
    if first.data_type == "FLOAT4X4":
        values[0] = np.eye(4).ravel()
    return replace(first, values=values, corners=np.zeros((len(mesh.triangles), width), np.int32))
