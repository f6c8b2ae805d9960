# SPDX-License-Identifier: GPL-3.0-or-later

"""E57 files: pages with checksums, a description in XML, and packets of packed values.

See ASTM E2807-11, Standard Specification for 3D Imaging Data Exchange.
"""

import functools
import math
import os
import struct
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

_SIGNATURE = b"ASTM-E57"
_HEADER_SIZE = 48
_PAGE = 1024
_CONTENTS = _PAGE - 4
"""Bytes of a page before its checksum."""
_PAGES_AT_ONCE = 1024
_POLYNOMIAL = 0x82F63B78
"""That of CRC-32C, its bits reversed."""

_DATA_PACKET = 1
_KNOWN_PACKETS = frozenset({0, _DATA_PACKET, 2})
_VECTOR_HEAD = 32
_LOWEST, _HIGHEST = -(2**63), 2**63 - 1

Floats = npt.NDArray[np.float64]


class PagedFile:
    """The contents of a file without the checksums at the end of each page."""

    def __init__(self, file: BinaryIO) -> None:
        """Takes a file that is open. Raises ValueError where it is no E57 file."""
        self._file = file
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        head = file.read(_HEADER_SIZE)
        if head[:8] != _SIGNATURE or len(head) < _HEADER_SIZE:
            raise ValueError(f"it begins with {head[:8]!r}")
        _, length, begin, self._text_length, page = struct.unpack_from("<QQQQQ", head, 8)
        if page != _PAGE:
            raise ValueError(f"it has pages of {page} bytes; {_PAGE} are needed")
        if length > size or size < _PAGE:
            raise ValueError(f"it has {size} of the {length} bytes in its header")
        self._pages = size // _PAGE
        self._text_begin = logical(begin)
        self._block = -1
        self._contents = b""

    def text(self) -> bytes:
        """The description in XML."""
        return self.read(self._text_begin, self._text_length)

    def read(self, begin: int, count: int) -> bytes:
        """Reads some bytes of the contents. Raises ValueError where these end, or are damaged."""
        if begin < 0 or begin + count > self._pages * _CONTENTS:
            raise ValueError(f"it ends before byte {begin + count} of its contents")
        found = []
        while count > 0:
            per_block = _PAGES_AT_ONCE * _CONTENTS
            self._load(begin // per_block)
            some = self._contents[begin % per_block :][:count]
            found.append(some)
            begin += len(some)
            count -= len(some)
        return b"".join(found)

    def _load(self, block: int) -> None:
        if block == self._block:
            return
        first = block * _PAGES_AT_ONCE
        count = min(_PAGES_AT_ONCE, self._pages - first)
        self._file.seek(first * _PAGE)
        data = np.frombuffer(self._file.read(count * _PAGE), np.uint8).reshape(count, _PAGE)
        contents = data[:, :_CONTENTS]
        expected = np.ascontiguousarray(data[:, _CONTENTS:]).view(">u4")[:, 0]
        wrong = np.flatnonzero(_checksums(contents) != expected)
        if len(wrong):
            raise ValueError(f"the checksum of page {first + int(wrong[0])} does not agree")
        self._block = block
        self._contents = contents.tobytes()


def logical(physical: int) -> int:
    """Where in the contents of pages a place of the file is."""
    page, place = divmod(physical, _PAGE)
    return page * _CONTENTS + min(place, _CONTENTS)


@functools.cache
def _checksum_parts() -> tuple[npt.NDArray[np.uint32], np.uint32]:
    """What each byte of a page adds to its checksum, (place, byte); and that of a page of zeros."""
    table = np.arange(256, dtype=np.uint32)
    for _ in range(8):
        table = np.where(table & 1, (table >> 1) ^ np.uint32(_POLYNOMIAL), table >> 1)
    parts = np.empty((_CONTENTS, 256), np.uint32)
    parts[-1] = table
    for place in range(_CONTENTS - 2, -1, -1):
        later = parts[place + 1]
        parts[place] = table[later & 255] ^ (later >> 8)
    zeros = np.uint32(0xFFFFFFFF)
    for _ in range(_CONTENTS):
        zeros = table[zeros & np.uint32(255)] ^ (zeros >> np.uint32(8))
    return parts, zeros ^ np.uint32(0xFFFFFFFF)


def _checksums(pages: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint32]:
    """CRC-32C of each row. It is linear: bytes add to it what they would add alone."""
    parts, zeros = _checksum_parts()
    found = np.empty(len(pages), np.uint32)
    places = np.arange(_CONTENTS)
    for k in range(0, len(pages), 64):  # As many as a cache holds.
        found[k : k + 64] = np.bitwise_xor.reduce(parts[places, pages[k : k + 64]], axis=1)
    return found ^ zeros


@dataclass(frozen=True)
class Field:
    """A value that each point has.

    Attributes:
        name: Of the element, without its namespace.
        bits: How many a value takes.
        code: Type of numpy, for floating-point numbers and text; "" for packed whole numbers.
        low: What is added to a packed number.
        scale: What the sum is multiplied by.
        offset: What is added then.
    """

    name: str
    bits: int
    code: str = ""
    low: int = 0
    scale: float = 1.0
    offset: float = 0.0

    def values(self, data: bytes, count: int) -> Floats:
        """Unpacks so many values, from the first bit on."""
        if self.code:
            return np.frombuffer(data, self.code, count).astype(np.float64)
        if self.bits == 0:
            raw = np.zeros(count, np.uint64)
        else:
            bits = np.unpackbits(
                np.frombuffer(data, np.uint8), count=count * self.bits, bitorder="little"
            )
            wide = np.zeros((count, 64), np.uint8)
            wide[:, : self.bits] = bits.reshape(count, self.bits)
            raw = np.packbits(wide, axis=1, bitorder="little").view("<u8")[:, 0]
        # Sums of integers stay exact where they exceed what a double holds.
        whole = (raw + np.uint64(self.low % 2**64)).view(np.int64)
        return whole.astype(np.float64) * self.scale + self.offset


@dataclass(frozen=True, eq=False)
class Scan:
    """The points of one scan.

    Attributes:
        fields: What points have.
        count: How many points there are.
        begin: Where in the file their section is.
        has_pose: The file says where the scanner stood.
        rotation: (3, 3), from the scanner's coordinates to the file's.
        translation: (3,), what is added then.
        highest_colors: (3,), those of red, green and blue.
    """

    fields: list[Field]
    count: int
    begin: int
    has_pose: bool
    rotation: Floats
    translation: Floats
    highest_colors: Floats

    @property
    def names(self) -> set[str]:
        return {field.name for field in self.fields}

    def values(self, file: PagedFile, names: list[str], most: int) -> Iterator[dict[str, Floats]]:
        """Yields values of points by the names of fields, `most` points at a time.

        `most` is a multiple of 8. Raises ValueError where the file is damaged.
        """
        wanted = [k for k, field in enumerate(self.fields) if field.name in names]
        streams = {k: bytearray() for k in wanted}
        left = self.count
        packets = self._packets(file)
        while left > 0:
            some = min(most, left)
            sizes = {k: (some * self.fields[k].bits + 7) // 8 for k in wanted}
            while any(len(streams[k]) < sizes[k] for k in wanted):
                parts = next(packets, None)
                if parts is None:
                    there = min(
                        len(streams[k]) * 8 // self.fields[k].bits for k in wanted if sizes[k]
                    )
                    raise ValueError(
                        f"a scan ends after {self.count - left + min(there, some)} of the "
                        f"{self.count} points in its header"
                    )
                for k in wanted:
                    streams[k] += parts[k]
            found = {}
            for k in wanted:
                found[self.fields[k].name] = self.fields[k].values(
                    bytes(streams[k][: sizes[k]]), some
                )
                del streams[k][: sizes[k]]
            left -= some
            yield found

    def _packets(self, file: PagedFile) -> Iterator[list[bytes]]:
        """Yields what each packet holds of each field."""
        begin = logical(self.begin)
        head = file.read(begin, _VECTOR_HEAD)
        length, data = struct.unpack_from("<8xQQ", head)
        if head[0] != 1:
            raise ValueError(f"its section at byte {self.begin} is none of points")
        place, end = logical(data), begin + length
        while place < end:
            head = file.read(place, 6)
            kind, size, count = struct.unpack("<BxHH", head)
            if kind not in _KNOWN_PACKETS:
                raise ValueError(f"a packet of kind {kind}; 0, 1 or 2 is needed")
            if kind == _DATA_PACKET:
                packet = file.read(place, size + 1)
                if count != len(self.fields):
                    raise ValueError(f"a packet of {count} fields; {len(self.fields)} are needed")
                yield _parts(packet, count)
            place += size + 1


def _parts(packet: bytes, count: int) -> list[bytes]:
    if len(packet) < 6 + 2 * count:
        raise ValueError("a packet is too short for its fields")
    found, place = [], 6 + 2 * count
    for size in struct.unpack_from(f"<{count}H", packet, 6):
        found.append(packet[place : place + size])
        place += size
    if place > len(packet):
        raise ValueError("a packet is too short for its fields")
    return found


def read_scans(file: PagedFile) -> list[Scan]:
    """Reads what the file says of its scans. Raises ValueError where it is damaged."""
    root = ET.fromstring(file.text())
    found = _child(root, "data3D")
    return [_scan(each) for each in found] if found is not None else []


def _scan(element: ET.Element) -> Scan:
    points = _child(element, "points")
    prototype = None if points is None else _child(points, "prototype")
    if points is None or prototype is None:
        raise ValueError("a scan has no points")
    pose = _child(element, "pose")
    turn = None if pose is None else _child(pose, "rotation")
    place = None if pose is None else _child(pose, "translation")
    colors = _child(element, "colorLimits")
    names = ("colorRedMaximum", "colorGreenMaximum", "colorBlueMaximum")
    return Scan(
        [_field(each) for each in prototype],
        int(points.get("recordCount", "0")),
        int(points.get("fileOffset", "0")),
        pose is not None,
        _rotation([_number(turn, name, float(name == "w")) for name in "wxyz"]),
        np.array([_number(place, name, 0.0) for name in "xyz"]),
        np.array([_number(colors, name, 255.0) for name in names]),
    )


def _field(element: ET.Element) -> Field:
    name, kind = _name(element), element.get("type")
    if kind == "Float":
        code = "<f4" if element.get("precision") == "single" else "<f8"
        return Field(name, 8 * np.dtype(code).itemsize, code)
    if kind in ("Integer", "ScaledInteger"):
        low, high = int(element.get("minimum", _LOWEST)), int(element.get("maximum", _HIGHEST))
        if not _LOWEST <= low <= high <= _HIGHEST:
            raise ValueError(f"'{name}' has values from {low} to {high}")
        scale, offset = float(element.get("scale", 1.0)), float(element.get("offset", 0.0))
        return Field(name, (high - low).bit_length(), "", low, scale, offset)
    # Text and structures, of which nothing is used, have streams of their own.
    return Field("", 8, "u1")


def _rotation(quaternion: list[float]) -> Floats:
    length = math.sqrt(sum(x * x for x in quaternion))
    if not (length > 0.0 and math.isfinite(length)):
        raise ValueError(f"a scan is turned by the quaternion {quaternion}")
    w, x, y, z = (each / length for each in quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _name(element: ET.Element) -> str:
    return element.tag.rpartition("}")[2]


def _child(element: ET.Element, name: str) -> ET.Element | None:
    return next((each for each in element if _name(each) == name), None)


def _number(element: ET.Element | None, name: str, usual: float) -> float:
    found = None if element is None else _child(element, name)
    if found is None:
        return usual
    # A number that is 0 may have no text; one that is scaled says by how much.
    value = float((found.text or "0").strip() or 0.0)
    return value * float(found.get("scale", 1.0)) + float(found.get("offset", 0.0))
