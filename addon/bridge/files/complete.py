# SPDX-License-Identifier: GPL-3.0-or-later

"""Whether files of meshes are whole, which Blender's exporters do not tell.

They go on after a write that fails, as on a full disk, and report success.
"""

import os
import struct
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

_PLY_SIZES = {
    **dict.fromkeys(("char", "uchar", "int8", "uint8"), 1),
    **dict.fromkeys(("short", "ushort", "int16", "uint16"), 2),
    **dict.fromkeys(("int", "uint", "float", "int32", "uint32", "float32"), 4),
    **dict.fromkeys(("double", "float64"), 8),
}
_STL_HEADER, _STL_TRIANGLE = 84, 50


def check_whole(folder: Path, vertices: int, faces: int) -> None:
    """Checks that files which Blender wrote are whole.

    Args:
        folder: It holds nothing else. What is neither OBJ, PLY nor STL must only reach the disk.
        vertices: How many an OBJ file has at least.
        faces: The same.

    Raises:
        OSError: Something is missing at the end of a file, or amid it.
    """
    checks: dict[str, Callable[[BinaryIO], bool]] = {
        ".stl": _is_whole_stl,
        ".ply": _is_whole_ply,
        ".obj": lambda file: _is_whole_obj(file, vertices, faces),
        ".mtl": _is_whole_text,
    }
    for path in folder.iterdir():
        with path.open("rb+") as file:
            # Some file systems tell only now that there is no room.
            os.fsync(file.fileno())
            check = checks.get(path.suffix.lower())
            if check is not None and not check(file):
                raise OSError(f"'{path.name}' was not written as a whole; is the disk full?")


def _is_whole_stl(file: BinaryIO) -> bool:
    header = file.read(_STL_HEADER)
    if len(header) < _STL_HEADER:
        return False
    (count,) = struct.unpack_from("<I", header, 80)
    return bool(_size(file) == _STL_HEADER + count * _STL_TRIANGLE)


def _is_whole_ply(file: BinaryIO) -> bool:
    """Follows a binary file from element to element; lists have counts of a byte."""
    header, found, contents = file.read().partition(b"end_header\n")
    if not found:
        return False
    elements: list[tuple[int, list[list[str]]]] = []
    for line in header.decode("ascii", "replace").splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((int(words[2]), []))
        elif words[0] == "property":
            elements[-1][1].append(words[1:])
    place = 0
    for count, properties in elements:
        lists = [kind for kind in properties if kind[0] == "list"]
        fixed = sum(_PLY_SIZES[kind[0]] for kind in properties if kind[0] != "list")
        if not lists:
            place += count * fixed
            continue
        # Blender writes the corners of a face, and nothing beside them.
        assert len(lists) == len(properties) == 1
        assert _PLY_SIZES[lists[0][1]] == 1
        size = _PLY_SIZES[lists[0][2]]
        for _ in range(count):
            if place >= len(contents):
                return False
            place += 1 + size * contents[place]
    return place == len(contents)


def _is_whole_obj(file: BinaryIO, vertices: int, faces: int) -> bool:
    counts, last = {b"v": 0, b"f": 0}, b"\n"
    for line in file:
        last = line
        kind = line[: line.find(b" ")]
        if kind in counts:
            counts[kind] += 1
    return last.endswith(b"\n") and counts[b"v"] >= vertices and counts[b"f"] >= faces


def _is_whole_text(file: BinaryIO) -> bool:
    return file.read()[-1:] in (b"", b"\n")


def _size(file: BinaryIO) -> int:
    return file.seek(0, os.SEEK_END)
