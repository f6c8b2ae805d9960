# SPDX-License-Identifier: GPL-3.0-or-later

"""Reads the triangles of the OBJ and PLY files that are gathered beside the checkout.

Needs numpy alone, so that nothing else counts in the measured memory.
"""

import base64
import io
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

DATA = Path(__file__).resolve().parents[3] / "shared/data/meshes"
PLY_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "int8": "i1",
    "uint8": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "int32": "i4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}


@dataclass(frozen=True)
class Triangles:
    """Positions (n, 3) and their indices (m, 3)."""

    positions: NDArray[np.float64]
    triangles: NDArray[np.int64]

    @property
    def corners(self) -> NDArray[np.float64]:
        """The corners of each triangle, (m, 3, 3)."""
        return self.positions[self.triangles]

    @property
    def area_vectors(self) -> NDArray[np.float64]:
        """The normal of each triangle, as long as its area."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return 0.5 * np.cross(b - a, c - a)


def read(path: Path) -> Triangles:
    """Reads a file; polygons become fans.

    Raises:
        ValueError: The file is no OBJ, PLY or OFF that this reads.
    """
    readers = {".obj": _read_obj, ".ply": _read_ply, ".off": _read_off}
    if path.suffix not in readers:
        raise ValueError(f"{path}: only {', '.join(readers)} can be read")
    positions, faces = readers[path.suffix](path)
    fans = [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]
    return Triangles(np.asarray(positions, np.float64), np.asarray(fans, np.int64))


def read_gltf(path: Path) -> list[Triangles]:
    """Reads the triangles of each primitive of a glTF file; equal positions become one vertex."""
    scene = json.loads(path.read_text())
    buffers = []
    for buffer in scene["buffers"]:
        uri = buffer["uri"]
        if uri.startswith("data:"):
            buffers.append(base64.b64decode(uri.split(",", 1)[1]))
        else:
            buffers.append((path.parent / uri).read_bytes())

    def values(number: int) -> NDArray:
        accessor = scene["accessors"][number]
        view = scene["bufferViews"][accessor["bufferView"]]
        dtype = np.dtype(
            {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
        )
        width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", width * dtype.itemsize)
        count = accessor["count"]
        raw = np.frombuffer(
            buffers[view["buffer"]], np.uint8, (count - 1) * stride + width * dtype.itemsize, start
        )
        rows = np.lib.stride_tricks.as_strided(raw, (count, width * dtype.itemsize), (stride, 1))
        return np.ascontiguousarray(rows).view(dtype)

    found = []
    for mesh in scene["meshes"]:
        for primitive in mesh["primitives"]:
            if primitive.get("mode", 4) != 4:
                continue
            positions = values(primitive["attributes"]["POSITION"]).astype(np.float64)
            indices = values(primitive["indices"]).astype(np.int64).reshape(-1, 3)
            unique, which = np.unique(positions, axis=0, return_inverse=True)
            triangles = which.ravel()[indices]
            whole = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
            found.append(Triangles(unique, triangles[whole]))
    return found


def _read_obj(path: Path) -> tuple[list, list]:
    positions, faces = [], []
    for line in path.read_text(errors="replace").splitlines():
        kind, *fields = line.split() or [""]
        if kind == "v":
            positions.append([float(x) for x in fields[:3]])
        elif kind == "f":
            numbers = [int(field.split("/")[0]) for field in fields]
            faces.append([n - 1 if n > 0 else len(positions) + n for n in numbers])
    return positions, faces


def _read_off(path: Path) -> tuple[list, list]:
    words = path.read_text().split()
    count, faces, place = int(words[1]), [], 4
    positions = np.array(words[place : place + 3 * count], float).reshape(-1, 3)
    place += 3 * count
    for _ in range(int(words[2])):
        size = int(words[place])
        faces.append([int(word) for word in words[place + 1 : place + 1 + size]])
        place += 1 + size
    return list(positions), faces


def _read_ply(path: Path) -> tuple[NDArray, list]:
    header, body = path.read_bytes().split(b"end_header\n", 1)
    elements: list[tuple[str, int, list]] = []
    order = "<"
    for line in header.decode().splitlines():
        kind, *fields = line.split() or [""]
        if kind == "format":
            order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[fields[0]]
        elif kind == "element":
            elements.append((fields[0], int(fields[1]), []))
        elif kind == "property":
            elements[-1][2].append(fields)
    stream = io.BytesIO(body)
    found = {}
    for name, count, properties in elements:
        found[name] = [_ply_row(stream, properties, order) for _ in range(count)]
    positions = np.array([[row[axis] for axis in "xyz"] for row in found["vertex"]])
    key = "vertex_indices" if "vertex_indices" in found["face"][0] else "vertex_index"
    return positions, [row[key] for row in found["face"]]


def _ply_row(stream: io.BytesIO, properties: list, order: str) -> dict:
    words = iter(() if order else stream.readline().split())

    def take(kind: str, count: int) -> list:
        if not order:
            return [float(next(words)) for _ in range(count)]
        dtype = np.dtype(order + PLY_TYPES[kind])
        return np.frombuffer(stream.read(dtype.itemsize * count), dtype).tolist()

    row = {}
    for fields in properties:
        if fields[0] == "list":
            (count,) = take(fields[1], 1)
            row[fields[3]] = [int(i) for i in take(fields[2], int(count))]
        else:
            (row[fields[1]],) = take(fields[0], 1)
    return row
