# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks that exported mesh files are complete.

Blender's exporters ignore failed writes, as on a full disk, and report success.
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
    """Checks that files written by Blender are complete.

    Args:
        folder: Folder with only these files. Formats other than OBJ, PLY and STL are only flushed
            to the disk.
        vertices: Least number of vertices of an OBJ file.
        faces: Least number of faces of an OBJ file.

    Raises:
        OSError: A file is truncated or lacks a part.
    """
    checks: dict[str, Callable[[BinaryIO], bool]] = {
        ".stl": _is_whole_stl,
        ".ply": _is_whole_ply,
        ".obj": lambda file: _is_whole_obj(file, vertices, faces),
        ".mtl": _is_whole_text,
    }
    for path in folder.iterdir():
        with path.open("rb+") as file:
            # Some file systems report a full disk only on fsync.
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
    """Walks through the elements of a binary file; lists have one-byte counts."""
    header, separator, contents = file.read().partition(b"end_header\n")
    if not separator:
        return False
    elements: list[tuple[int, list[list[str]]]] = []
    for line in header.decode("ascii", "replace").splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((int(words[2]), []))
        elif words[0] == "property":
            elements[-1][1].append(words[1:])
    position = 0
    for count, properties in elements:
        lists = [kind for kind in properties if kind[0] == "list"]
        fixed = sum(_PLY_SIZES[kind[0]] for kind in properties if kind[0] != "list")
        if not lists:
            position += count * fixed
            continue
        # The faces that Blender writes have only the list of corners.
        assert len(lists) == len(properties) == 1
        assert _PLY_SIZES[lists[0][1]] == 1
        size = _PLY_SIZES[lists[0][2]]
        for _ in range(count):
            if position >= len(contents):
                return False
            position += 1 + size * contents[position]
    return position == len(contents)


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
