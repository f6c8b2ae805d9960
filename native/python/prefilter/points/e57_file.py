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
"""Size of a page without its checksum, in bytes."""
_PAGES_AT_ONCE = 1024
_POLYNOMIAL = 0x82F63B78
"""Polynomial of CRC-32C, bits reversed."""

_DATA_PACKET = 1
_KNOWN_PACKETS = frozenset({0, _DATA_PACKET, 2})
_VECTOR_HEAD = 32
_LOWEST, _HIGHEST = -(2**63), 2**63 - 1

Floats = npt.NDArray[np.float64]


class PagedFile:
    """Contents of a file without the checksums at the end of each page."""

    def __init__(self, file: BinaryIO) -> None:
        """Reads the header of an open file. Raises ValueError where it is no E57 file."""
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
        """Reads `count` bytes of the contents. Raises ValueError at their end or for damage."""
        if begin < 0 or begin + count > self._pages * _CONTENTS:
            raise ValueError(f"it ends before byte {begin + count} of its contents")
        pieces = []
        while count > 0:
            per_block = _PAGES_AT_ONCE * _CONTENTS
            self._load(begin // per_block)
            piece = self._contents[begin % per_block :][:count]
            pieces.append(piece)
            begin += len(piece)
            count -= len(piece)
        return b"".join(pieces)

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
    """Converts an offset in the file to one in the contents of its pages."""
    page, offset = divmod(physical, _PAGE)
    return page * _CONTENTS + min(offset, _CONTENTS)


@functools.cache
def _checksum_parts() -> tuple[npt.NDArray[np.uint32], np.uint32]:
    """Contribution of each byte to a page's checksum, [offset, byte]; checksum of a zero page."""
    table = np.arange(256, dtype=np.uint32)
    for _ in range(8):
        table = np.where(table & 1, (table >> 1) ^ np.uint32(_POLYNOMIAL), table >> 1)
    parts = np.empty((_CONTENTS, 256), np.uint32)
    parts[-1] = table
    for offset in range(_CONTENTS - 2, -1, -1):
        later = parts[offset + 1]
        parts[offset] = table[later & 255] ^ (later >> 8)
    zeros = np.uint32(0xFFFFFFFF)
    for _ in range(_CONTENTS):
        zeros = table[zeros & np.uint32(255)] ^ (zeros >> np.uint32(8))
    return parts, zeros ^ np.uint32(0xFFFFFFFF)


def _checksums(pages: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint32]:
    """CRC-32C of each row, as the sum of its bytes' contributions: the checksum is linear."""
    parts, zeros = _checksum_parts()
    sums = np.empty(len(pages), np.uint32)
    offsets = np.arange(_CONTENTS)
    for k in range(0, len(pages), 64):  # 64 pages fit into a cache.
        sums[k : k + 64] = np.bitwise_xor.reduce(parts[offsets, pages[k : k + 64]], axis=1)
    return sums ^ zeros


@dataclass(frozen=True)
class Field:
    """Format of one value per point.

    Attributes:
        name: Name of the element, without its namespace.
        bits: Number of bits per value.
        code: numpy's type code, for floating-point numbers and text; "" for packed integers.
        low: Added to a packed integer.
        scale: Multiplies that sum.
        offset: Added to that product.
    """

    name: str
    bits: int
    code: str = ""
    low: int = 0
    scale: float = 1.0
    offset: float = 0.0

    def values(self, data: bytes, count: int) -> Floats:
        """Unpacks `count` values, from the first bit on."""
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
        # Integer sums stay exact beyond the 53 bits of a double.
        whole = (raw + np.uint64(self.low % 2**64)).view(np.int64)
        return whole.astype(np.float64) * self.scale + self.offset


@dataclass(frozen=True, eq=False)
class Scan:
    """Points of one scan.

    Attributes:
        fields: Fields of the points.
        count: Number of points.
        begin: Offset of their section in the file.
        has_pose: Whether the file has the scanner's pose.
        rotation: (3, 3), from the scanner's coordinates to the file's.
        translation: (3,), added after the rotation.
        highest_colors: (3,), largest values of red, green and blue.
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
        """Yields values of points by field name, for `most` points at a time, a multiple of 8.

        Raises ValueError where the file is damaged.
        """
        used = [k for k, field in enumerate(self.fields) if field.name in names]
        streams = {k: bytearray() for k in used}
        left = self.count
        packets = self._packets(file)
        while left > 0:
            count = min(most, left)
            sizes = {k: (count * self.fields[k].bits + 7) // 8 for k in used}
            while any(len(streams[k]) < sizes[k] for k in used):
                parts = next(packets, None)
                if parts is None:
                    complete = min(
                        len(streams[k]) * 8 // self.fields[k].bits for k in used if sizes[k]
                    )
                    raise ValueError(
                        f"a scan ends after {self.count - left + min(complete, count)} of the "
                        f"{self.count} points in its header"
                    )
                for k in used:
                    streams[k] += parts[k]
            columns = {}
            for k in used:
                columns[self.fields[k].name] = self.fields[k].values(
                    bytes(streams[k][: sizes[k]]), count
                )
                del streams[k][: sizes[k]]
            left -= count
            yield columns

    def _packets(self, file: PagedFile) -> Iterator[list[bytes]]:
        """Yields the bytes of each field, packet by packet."""
        begin = logical(self.begin)
        head = file.read(begin, _VECTOR_HEAD)
        length, data = struct.unpack_from("<8xQQ", head)
        if head[0] != 1:
            raise ValueError(f"its section at byte {self.begin} is none of points")
        offset, end = logical(data), begin + length
        while offset < end:
            head = file.read(offset, 6)
            kind, size, count = struct.unpack("<BxHH", head)
            if kind not in _KNOWN_PACKETS:
                raise ValueError(f"a packet of kind {kind}; 0, 1 or 2 is needed")
            if kind == _DATA_PACKET:
                packet = file.read(offset, size + 1)
                if count != len(self.fields):
                    raise ValueError(f"a packet of {count} fields; {len(self.fields)} are needed")
                yield _parts(packet, count)
            offset += size + 1


def _parts(packet: bytes, count: int) -> list[bytes]:
    if len(packet) < 6 + 2 * count:
        raise ValueError("a packet is too short for its fields")
    parts, offset = [], 6 + 2 * count
    for size in struct.unpack_from(f"<{count}H", packet, 6):
        parts.append(packet[offset : offset + size])
        offset += size
    if offset > len(packet):
        raise ValueError("a packet is too short for its fields")
    return parts


def read_scans(file: PagedFile) -> list[Scan]:
    """Reads the descriptions of all scans. Raises ValueError where the file is damaged."""
    root = ET.fromstring(file.text())
    scans = _child(root, "data3D")
    return [_scan(each) for each in scans] if scans is not None else []


def _scan(element: ET.Element) -> Scan:
    points = _child(element, "points")
    prototype = None if points is None else _child(points, "prototype")
    if points is None or prototype is None:
        raise ValueError("a scan has no points")
    pose = _child(element, "pose")
    rotation = None if pose is None else _child(pose, "rotation")
    translation = None if pose is None else _child(pose, "translation")
    colors = _child(element, "colorLimits")
    names = ("colorRedMaximum", "colorGreenMaximum", "colorBlueMaximum")
    return Scan(
        [_field(each) for each in prototype],
        int(points.get("recordCount", "0")),
        int(points.get("fileOffset", "0")),
        pose is not None,
        _rotation([_number(rotation, name, float(name == "w")) for name in "wxyz"]),
        np.array([_number(translation, name, 0.0) for name in "xyz"]),
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
    # Text and structures are not used, but have streams of their own.
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


def _number(element: ET.Element | None, name: str, default: float) -> float:
    child = None if element is None else _child(element, name)
    if child is None:
        return default
    # The text of a zero may be missing. Scaled numbers have attributes for scale and offset.
    value = float((child.text or "0").strip() or 0.0)
    return value * float(child.get("scale", 1.0)) + float(child.get("offset", 0.0))
