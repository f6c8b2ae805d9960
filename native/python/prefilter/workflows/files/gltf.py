# SPDX-License-Identifier: GPL-3.0-or-later

"""Reader of glTF files: triangles in world coordinates."""

import base64
import json
import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

import numpy as np
from numpy.typing import NDArray

from ..matrices import inner, product
from .polygons import PolygonMesh, rounded

_TYPES: dict[int, Any] = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_JSON, _BINARY = 0x4E4F534A, 0x004E4942
_COMPRESSIONS = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")


def read_gltf(path: str) -> list[PolygonMesh]:
    """Returns the meshes of the default scene, one for each node that shows one.

    Raises:
        OSError: A file that it refers to cannot be read.
        ValueError: The file is damaged, or compressed by an extension.
    """
    file = _File(Path(path))
    return [mesh for mesh in file.meshes() if len(mesh.corners)]


class _File:
    """A glTF file, and its buffers."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        self._folder = path.parent
        self._binary: bytes | None = None
        if data[:4] == b"glTF":
            data = self._chunks(data)
        try:
            self._tree = json.loads(data.decode("utf-8-sig"))
        except json.JSONDecodeError as error:
            where = f"line {error.lineno}, column {error.colno}"
            raise ValueError(f"its JSON is damaged from {where} on") from error
        except (ValueError, RecursionError) as error:
            raise ValueError("its JSON is damaged") from error
        for name in _COMPRESSIONS:
            if name in self._list("extensionsRequired"):
                raise ValueError(f"it is compressed by {name}; export it without compression")
        self._buffers: dict[int, bytes] = {}

    def meshes(self) -> Iterator[PolygonMesh]:
        """Yields the meshes that the default scene shows."""
        nodes, scenes = self._list("nodes"), self._list("scenes")
        children = {child for node in nodes for child in node.get("children", ())}
        roots = [number for number in range(len(nodes)) if number not in children]
        if scenes:
            roots = list(scenes[self._tree.get("scene", 0)].get("nodes", ()))
        pending = [(number, np.eye(4)) for number in reversed(roots)]
        seen = set()
        while pending:
            number, above = pending.pop()
            if number in seen:
                raise ValueError(f"node {number} has two parents")
            seen.add(number)
            node = nodes[number]
            matrix = product(above, _matrix(node))
            if "mesh" in node:
                yield self._mesh(node, matrix)
            pending += [(child, matrix) for child in reversed(node.get("children", ()))]

    def _chunks(self, data: bytes) -> bytes:
        """Returns the JSON of a .glb file, and stores its buffer."""
        text, start = b"", 12
        while start + 8 <= len(data):
            length, kind = struct.unpack_from("<II", data, start)
            chunk = data[start + 8 : start + 8 + length]
            if len(chunk) < length:
                break
            if kind == _JSON:
                text = chunk
            elif kind == _BINARY and self._binary is None:
                self._binary = chunk
            start += 8 + length
        return text

    def _list(self, key: str) -> Any:
        return self._tree.get(key, ())

    def _mesh(self, node: Any, matrix: NDArray[np.float64]) -> PolygonMesh:
        mesh = self._list("meshes")[node["mesh"]]
        name = mesh.get("name") or node.get("name") or f"Mesh {node['mesh']}"
        places, corners, uvs, count = [], [], [], 0
        for primitive in mesh["primitives"]:
            attributes = primitive["attributes"]
            mode = primitive.get("mode", _TRIANGLES)
            if mode not in (_TRIANGLES, _STRIP, _FAN) or "POSITION" not in attributes:
                continue
            points = rounded(self._values(attributes["POSITION"]))
            if not np.array_equal(matrix, np.eye(4)):
                points = product(points, matrix[:3, :3].T) + matrix[:3, 3]
            order = np.arange(len(points))
            if "indices" in primitive:
                order = self._values(primitive["indices"]).astype(np.int64).reshape(-1)
            if order.size and order.max() >= len(points):
                raise ValueError(f"mesh '{name}' names vertex {order.max()} of {len(points)}")
            triangles = _triangles(order, mode)
            if inner(np.cross(matrix[0, :3], matrix[1, :3]), matrix[2, :3]) < 0:
                triangles = triangles[:, ::-1]
            coordinates = np.full((len(points), 2), np.nan)
            if "TEXCOORD_0" in attributes:
                down = self._values(attributes["TEXCOORD_0"]).astype(np.float32)
                coordinates = rounded(np.stack([down[:, 0], np.float32(1) - down[:, 1]], axis=1))
            places.append(points)
            corners.append(triangles.reshape(-1) + count)
            uvs.append(coordinates[triangles.reshape(-1)])
            count += len(points)
        if not places:
            none = np.empty(0, np.int64)
            return PolygonMesh(name, np.empty((0, 3)), none, none, None)
        joined = np.concatenate(corners)
        has_uvs = any("TEXCOORD_0" in one["attributes"] for one in mesh["primitives"])
        return PolygonMesh(
            name,
            np.concatenate(places),
            joined,
            np.full(len(joined) // 3, 3, np.int64),
            np.concatenate(uvs) if has_uvs else None,
        )

    def _values(self, number: int) -> NDArray[Any]:
        """Returns the values of an accessor as rows; normalized ones as fractions."""
        accessor = self._list("accessors")[number]
        kind, width = np.dtype(_TYPES[accessor["componentType"]]), _WIDTHS[accessor["type"]]
        count = accessor["count"]
        elements: NDArray[Any] = np.zeros((count, width), kind)
        if "bufferView" in accessor:
            start = accessor.get("byteOffset", 0)
            elements = self._rows(accessor["bufferView"], start, kind, (count, width)).copy()
        elif "sparse" not in accessor:
            raise ValueError(f"accessor {number} has no values; is the file compressed?")
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            places, values = sparse["indices"], sparse["values"]
            shape = (sparse["count"], 1)
            order = self._rows(
                *(places["bufferView"], places.get("byteOffset", 0)),
                *(np.dtype(_TYPES[places["componentType"]]), shape),
            )
            start = values.get("byteOffset", 0)
            rows = self._rows(values["bufferView"], start, kind, (sparse["count"], width))
            elements[order.reshape(-1)] = rows
        if accessor.get("normalized") and kind.kind in "iu":
            elements = np.maximum(elements.astype(np.float32) / np.iinfo(kind).max, np.float32(-1))
        return elements

    def _rows(
        self, view: int, start: int, kind: np.dtype[Any], shape: tuple[int, int]
    ) -> NDArray[Any]:
        buffer_view = self._list("bufferViews")[view]
        data = self._buffer(buffer_view["buffer"])
        begin, end = buffer_view.get("byteOffset", 0), buffer_view["byteLength"]
        data = data[begin : begin + end]
        stride = buffer_view.get("byteStride", shape[1] * kind.itemsize)
        needed = start + (shape[0] - 1) * stride + shape[1] * kind.itemsize
        if shape[0] and needed > len(data):
            raise ValueError(f"buffer view {view} ends too early")
        strides = (stride, kind.itemsize)
        return np.ndarray(shape, kind.newbyteorder("<"), data, start, strides)

    def _buffer(self, number: int) -> bytes:
        if number not in self._buffers:
            self._buffers[number] = self._read(self._list("buffers")[number].get("uri"))
        return self._buffers[number]

    def _read(self, uri: str | None) -> bytes:
        if uri is None:
            if self._binary is None:
                raise ValueError("a buffer has no data; is the file compressed?")
            return self._binary
        if uri.startswith("data:"):
            head, _, body = uri.partition(",")
            return base64.b64decode(body) if head.endswith(";base64") else unquote_to_bytes(body)
        with open(os.path.join(self._folder, unquote(uri)), "rb") as file:
            return file.read()


def _triangles(order: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """Returns (triangles, 3) vertex indices from the index order of a primitive."""
    if mode == _TRIANGLES:
        return order[: len(order) // 3 * 3].reshape(-1, 3)
    if len(order) < 3:
        return np.empty((0, 3), np.int64)
    if mode == _FAN:
        return np.stack([np.full(len(order) - 2, order[0]), order[1:-1], order[2:]], axis=1)
    triangles = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
    triangles[1::2] = triangles[1::2, [0, 2, 1]]
    return triangles


def _matrix(node: Any) -> NDArray[np.float64]:
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] *= np.array(node.get("scale", (1.0, 1.0, 1.0)))
    matrix[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return matrix
