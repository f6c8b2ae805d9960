# SPDX-License-Identifier: GPL-3.0-or-later

"""The triangles of a glTF file, from the exporter's data structures."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import prefilter
from mathutils import Matrix, Quaternion, Vector
from numpy.typing import NDArray

_TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}
_TRIANGLES = (None, 4)

Transform = tuple[tuple[float, float], float, tuple[float, float]]
"""A transform of texture coordinates: offset, rotation, scale, as in KHR_texture_transform."""


@dataclass(frozen=True)
class Part:
    """The triangles of a node's primitive.

    Attributes:
        name: The name of the node.
        primitive: The exporter's primitive.
        positions: (vertices, 3) in world space.
        triangles: (triangles, 3) indices.
        uvs: (vertices, 2) by number of the set, with v downwards.
    """

    name: str
    primitive: Any
    positions: NDArray[np.float64]
    triangles: NDArray[np.int64]
    uvs: dict[int, NDArray[np.float64]]

    def surface(self, tex_coord: int, transform: Transform) -> prefilter.Surface | None:
        """Returns the part as a surface under an image; None if it lacks the texture
        coordinates."""
        uvs = self.uvs.get(tex_coord)
        if uvs is None or not len(self.triangles):
            return None
        (left, top), angle, (wide, high) = transform
        cos, sin = math.cos(angle), math.sin(angle)
        u, v = uvs[:, 0] * wide, uvs[:, 1] * high
        placed = np.stack([cos * u + sin * v + left, 1 - (cos * v - sin * u + top)], axis=1)
        return prefilter.Surface(self.positions, self.triangles, placed)


def parts(scene: Any) -> Iterator[Part]:
    """Yields the triangles of a scene."""
    for node in scene.nodes:
        yield from _subtree(node, Matrix.Identity(4))


def _subtree(node: Any, parent: Matrix) -> Iterator[Part]:
    matrix = parent @ _matrix(node)
    for primitive in node.mesh.primitives if node.mesh is not None else ():
        if primitive.mode in _TRIANGLES and "POSITION" in primitive.attributes:
            yield _part(node.name, primitive, np.array(matrix))
    for child in node.children or ():
        yield from _subtree(child, matrix)


def _part(name: str, primitive: Any, matrix: NDArray[np.float64]) -> Part:
    points = values(primitive.attributes["POSITION"]).astype(np.float64)
    indices = np.arange(len(points))
    if primitive.indices is not None:
        indices = values(primitive.indices)[:, 0].astype(np.int64)
    uvs = {
        int(key.removeprefix("TEXCOORD_")): values(accessor).astype(np.float64)
        for key, accessor in primitive.attributes.items()
        if key.startswith("TEXCOORD_")
    }
    placed = points @ matrix[:3, :3].T + matrix[:3, 3]
    return Part(name, primitive, placed, indices.reshape(-1, 3), uvs)


def values(accessor: Any) -> NDArray[Any]:
    """Returns the values of an accessor, one element per row."""
    width = _WIDTHS[accessor.type]
    dtype = _TYPES[int(accessor.component_type)]
    flat = np.frombuffer(accessor.buffer_view.data, dtype, count=accessor.count * width)
    return flat.reshape(-1, width)


def _matrix(node: Any) -> Matrix:
    if node.matrix:
        return Matrix([node.matrix[i::4] for i in range(4)])
    x, y, z, w = node.rotation or (0.0, 0.0, 0.0, 1.0)
    return Matrix.LocRotScale(
        Vector(node.translation or (0.0, 0.0, 0.0)),
        Quaternion((w, x, y, z)),
        Vector(node.scale or (1.0, 1.0, 1.0)),
    )
