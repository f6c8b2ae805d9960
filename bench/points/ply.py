# SPDX-License-Identifier: GPL-3.0-or-later

"""Points and triangles in binary PLY files, whole arrays at a time."""

import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.voxels.meshes import PLY_TYPES, Triangles
from bench.voxels.meshes import read as read_any

Points = NDArray[np.float64]
Normals = NDArray[np.float32]
POINT = np.dtype([(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")])


def write_points(path: Path, count: int, pieces: Iterable[tuple[Points, Normals]]) -> None:
    """Writes points and normals as floats, piece by piece.

    Raises:
        ValueError: The pieces do not add up to `count` points; there is no file then.
    """
    names = "".join(f"property float {name}\n" for name in POINT.names)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{names}end_header\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    partial, written = path.with_suffix(".partial"), 0
    with partial.open("wb") as stream:
        stream.write(head.encode())
        for points, normals in pieces:
            np.hstack([points, normals]).astype("<f4").tofile(stream)
            written += len(points)
    if written != count:
        partial.unlink()
        raise ValueError(f"{path}: {written} points were made; {count} were announced")
    partial.rename(path)


def read_points(path: Path) -> tuple[NDArray[np.float32], Normals]:
    """Reads what `write_points` wrote, without a copy in memory; both are (n, 3)."""
    with path.open("rb") as stream:
        head = stream.read(1024).partition(b"end_header\n")[0]
    count = int(re.search(rb"element vertex (\d+)", head)[1])
    rows = np.memmap(path, "<f4", "r", len(head) + len("end_header\n"), (count, 6))
    return rows[:, :3], rows[:, 3:]


def read_mesh(path: Path) -> Triangles:
    """Reads a mesh; binary PLY of triangles at once, all else row by row."""
    if path.suffix != ".ply":
        return read_any(path)
    with path.open("rb") as stream:
        head = stream.read(4096).partition(b"end_header\n")[0].decode()
    first = head.partition("element face")[0]
    properties = re.findall(r"^property (?!list)(\w+) (\w+)$", first, re.MULTILINE)
    lists = re.findall(r"^property list (\w+) (\w+) vertex_ind(?:ex|ices)$", head, re.MULTILINE)
    simple = re.search(
        r"element vertex (\d+)\n(?:property .*\n)+element face (\d+)\nproperty list", head
    )
    if "binary_little_endian" not in head or len(lists) != 1 or not simple:
        return read_any(path)
    vertices, faces = map(int, simple.groups())
    vertex = np.dtype([(name, "<" + PLY_TYPES[kind]) for kind, name in properties])
    size, index = ("<" + PLY_TYPES[kind] for kind in lists[0])
    face = np.dtype([("size", size), ("corners", index, 3)])
    start = len(head) + len("end_header\n")
    if path.stat().st_size != start + vertices * vertex.itemsize + faces * face.itemsize:
        return read_any(path)
    body = np.fromfile(path, vertex, vertices, offset=start)
    corners = np.fromfile(path, face, faces, offset=start + vertices * vertex.itemsize)
    if not (corners["size"] == 3).all():
        return read_any(path)
    positions = np.stack([body[axis] for axis in "xyz"], axis=1).astype(np.float64)
    return Triangles(positions, corners["corners"].astype(np.int64))


def vertex_values(path: Path, name: str) -> NDArray[np.floating]:
    """Reads one property of the vertices of a binary PLY; those have to come first.

    Raises:
        ValueError: The file is no such one, or has no such property.
    """
    with path.open("rb") as stream:
        head = stream.read(4096).partition(b"end_header\n")[0].decode()
    count = re.search(r"element vertex (\d+)\n((?:property (?!list).*\n)+)", head)
    if "binary_little_endian" not in head or not count:
        raise ValueError(f"{path}: no binary PLY of vertices")
    properties = re.findall(r"property (\w+) (\w+)\n", count[2])
    vertex = np.dtype([(key, "<" + PLY_TYPES[kind]) for kind, key in properties])
    if name not in vertex.names:
        raise ValueError(f"{path}: vertices have no {name!r}")
    return np.fromfile(path, vertex, int(count[1]), offset=len(head) + len("end_header\n"))[name]


def write_mesh(path: Path, positions: Points, triangles: NDArray[np.integer]) -> None:
    """Writes triangles, with positions as floats."""
    face = np.dtype([("size", "u1"), ("corners", "<i4", 3)])
    faces = np.empty(len(triangles), face)
    faces["size"], faces["corners"] = 3, triangles
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with path.open("wb") as stream:
        stream.write(head.encode())
        np.asarray(positions, "<f4").tofile(stream)
        faces.tofile(stream)
