# SPDX-License-Identifier: GPL-3.0-or-later

"""Whether a PLY file holds what its header says: Blender's importer crashes where one does not."""

import mmap
import os
import re
import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

# Letters of the module struct.
_KINDS = {
    **dict.fromkeys(("char", "int8"), "b"),
    **dict.fromkeys(("uchar", "uint8"), "B"),
    **dict.fromkeys(("short", "int16"), "h"),
    **dict.fromkeys(("ushort", "uint16"), "H"),
    **dict.fromkeys(("int", "int32"), "i"),
    **dict.fromkeys(("uint", "uint32"), "I"),
    **dict.fromkeys(("float", "float32"), "f"),
    **dict.fromkeys(("double", "float64"), "d"),
}
_FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_ELEMENT = re.compile(r"element (\S+) (\d{1,12})")
_PROPERTY = re.compile(r"property (?:list (\S+) (\S+)|(\S+)) (\S+)")
_INDICES = ("vertex_indices", "vertex_index")
_END = re.compile(rb"end_header\r?\n")
_MOST_CORNERS = 64  # Of faces that are looked at all at once.


@dataclass
class _Property:
    """A value, or a list of values.

    Attributes:
        name: As the header calls it.
        kind: The letter of a value.
        length: That of the length of a list; empty for a single value.
    """

    name: str
    kind: str
    length: str = ""


@dataclass
class _Element:
    """A kind of thing: "vertex", "face" or another."""

    name: str
    count: int
    properties: list[_Property] = field(default_factory=list)

    @property
    def lists(self) -> list[_Property]:
        return [one for one in self.properties if one.length]


def is_whole(path: Path) -> bool:
    """Tells whether all elements are there, and corners of faces are vertices of the file."""
    with path.open("rb") as file:
        if os.fstat(file.fileno()).st_size == 0:
            return False
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            return _is_whole(data)


def _is_whole(data: mmap.mmap) -> bool:
    end = _END.search(data)
    if end is None or data[:3] != b"ply":
        return False
    header = _header(data[: end.start()].decode("latin-1").splitlines()[1:])
    if header is None:
        return False
    order, elements = header
    vertices = next((one.count for one in elements if one.name == "vertex"), 0)
    place = end.end()
    del end  # It holds the file open.
    if not order:
        return _is_whole_text(data[place:].split(b"\n"), elements, vertices)
    for element in elements:
        found = _after(data, place, element, order, vertices)
        if found is None:
            return False
        place = found
    return True


def _header(lines: list[str]) -> tuple[str, list[_Element]] | None:
    """Returns the order of bytes, empty for text, and the elements; None where it is damaged."""
    order: str | None = None
    elements: list[_Element] = []
    for line in lines:
        words = " ".join(line.split())
        if not words or words.split()[0] in ("comment", "obj_info"):
            continue
        if words.startswith("format "):
            order = _FORMATS.get(words.split()[1])
        elif match := _ELEMENT.fullmatch(words):
            elements.append(_Element(match[1], int(match[2])))
        elif (match := _PROPERTY.fullmatch(words)) and elements:
            length, member, single, name = match.groups()
            found = _Property(name, _KINDS.get(member or single, ""), _KINDS.get(length, ""))
            if not found.kind or (length and not found.length):
                return None
            elements[-1].properties.append(found)
        else:
            return None
    return None if order is None else (order, elements)


def _after(data: mmap.mmap, place: int, element: _Element, order: str, vertices: int) -> int | None:
    """Returns where an element of a binary file ends; None where it is not whole."""
    if not element.lists:
        row = struct.calcsize(order + "".join(one.kind for one in element.properties))
        end = place + element.count * row
        return end if end <= len(data) else None
    uniform = _after_uniform(data, place, element, order, vertices)
    if uniform is not None:
        return uniform
    try:
        for _ in range(element.count):
            for one in element.properties:
                if not one.length:
                    place += struct.calcsize(order + one.kind)
                    continue
                (length,) = struct.unpack_from(order + one.length, data, place)
                place += struct.calcsize(order + one.length)
                members = struct.unpack_from(f"{order}{int(length)}{one.kind}", data, place)
                if one.name in _INDICES and not all(0 <= each < vertices for each in members):
                    return None
                place += struct.calcsize(f"{order}{int(length)}{one.kind}")
    except struct.error:
        return None
    return place if place <= len(data) else None


def _after_uniform(
    data: mmap.mmap, place: int, element: _Element, order: str, vertices: int
) -> int | None:
    """Returns the same where all lists have the length of the first; None where they do not."""
    (one, *others) = element.lists
    if others or element.properties[-1] is not one or not element.count:
        return None
    fixed = struct.calcsize(order + "".join(each.kind for each in element.properties[:-1]))
    try:
        (length,) = struct.unpack_from(order + one.length, data, place + fixed)
    except struct.error:
        return None
    if not 0 < length <= _MOST_CORNERS:
        return None
    row = np.dtype(
        [
            ("fixed", f"V{fixed}"),
            ("length", order + one.length),
            ("members", order + one.kind, (int(length),)),
        ]
    )
    end = place + row.itemsize * element.count
    if end > len(data):
        return None
    rows = np.frombuffer(data[place:end], row)
    members = rows["members"]
    is_uniform = bool(np.all(rows["length"] == length))
    are_vertices = bool(np.all((members >= 0) & (members < vertices)))
    return end if is_uniform and (one.name not in _INDICES or are_vertices) else None


def _is_whole_text(lines: list[bytes], elements: list[_Element], vertices: int) -> bool:
    rows = [words for line in lines if (words := line.split())]
    place = 0
    for element in elements:
        part = rows[place : place + element.count]
        place += element.count
        if len(part) < element.count:
            return False
        if not all(_is_whole_row(row, element.properties, vertices) for row in part):
            return False
    return True


def _is_whole_row(words: list[bytes], properties: list[_Property], vertices: int) -> bool:
    place = 0
    for one in properties:
        place += 1
        if not one.length:
            continue
        try:
            length = int(words[place - 1])
            corners = words[place : place + length] if one.name in _INDICES else []
            if length < 0 or not all(0 <= int(word) < vertices for word in corners):
                return False
        except (ValueError, IndexError):
            return False
        place += length
    return place <= len(words)
