# SPDX-License-Identifier: GPL-3.0-or-later

"""Headers of LAS files: number of points, and layout of their records."""

import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from .._border.input import open_file

_SHORT_HEADER = 227
_LONG_HEADER = 255
_COMPRESSED = 0x80
_RECORD_HEAD = 54
_EXTRA_BYTES = 192

_START: list[tuple[str, str, int]] = [
    ("x", "<i4", 0),
    ("y", "<i4", 4),
    ("z", "<i4", 8),
    ("intensity", "<u2", 12),
    ("returns", "u1", 14),
]
_CLASS_OFFSETS = (15,) * 6 + (16,) * 5
_COLOR_OFFSETS = (None, None, 20, 28, None, 28, None, 30, 30, None, 30)
_SIZES = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
"""Offset of the class, offset of the colors and size of a record, in bytes, per point format."""

_EXTRA_TYPES = ("u1", "i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8")


@dataclass(frozen=True)
class ExtraDimension:
    """A value of the points beyond the standard ones.

    Attributes:
        name: Name in the file.
        field: Name in the layout, which may differ.
        scale: Multiplies a value.
        offset: Added to that product.
    """

    name: str
    field: str
    scale: float
    offset: float


@dataclass(frozen=True, eq=False)
class LasHeader:
    """Header of a LAS file.

    Attributes:
        point_format: 0 to 10.
        layout: Layout of a point's record: x, y, z, intensity, returns, classification, perhaps
            red, green and blue, and the fields of extra dimensions.
        begin: Offset of the first record, or of the compressed data, in bytes.
        count: Number of points.
        scales: Factors of x, y and z.
        offsets: Added to the scaled x, y and z.
        extra: Extra dimensions.
        packing: LASzip's record; None where there is none.
        is_compressed: Whether the file is a LAZ file.
    """

    point_format: int
    layout: np.dtype[np.void]
    begin: int
    count: int
    scales: npt.NDArray[np.float64]
    offsets: npt.NDArray[np.float64]
    extra: list[ExtraDimension]
    packing: bytes | None
    is_compressed: bool


def read_header(path: str) -> LasHeader:
    """Reads the header of a file and its records.

    Raises:
        ValueError: The file is no LAS file, or it is damaged.
        OSError: The file cannot be read.
    """
    with open_file(path) as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        head = file.read(_LONG_HEADER)
        if head[:4] != b"LASF" or len(head) < _SHORT_HEADER:
            raise ValueError(f"'{path}' is not a LAS file: it begins with {head[:4]!r}")
        head_size, begin, records = struct.unpack_from("<HII", head, 94)
        if max(begin, records * _RECORD_HEAD, _end_of_records(file, head, size)) > size:
            raise ValueError(f"'{path}': too short for the records that its header announces")
        extra_bytes, packing = b"", None
        for user, number, data in _records(path, file, head_size, records, begin):
            if (user, number) == (b"LASF_Spec", 4):
                extra_bytes = data
            elif (user, number) == (b"laszip encoded", 22204):
                packing = data
    kind, length, count = struct.unpack_from("<BHI", head, 104)
    point_format = kind & 0x3F
    if point_format >= len(_SIZES) or kind & 0x40 or length < _SIZES[point_format]:
        raise ValueError(
            f"'{path}' cannot be read as a LAS file: points of format {kind & 0x7F} with {length} "
            "bytes; 0 to 10 are known, with at least as many bytes as they need"
        )
    if head[25] >= 4 and len(head) == _LONG_HEADER:
        (count,) = struct.unpack_from("<Q", head, 247)
    fields = [*_START, ("classification", "u1", _CLASS_OFFSETS[point_format])]
    colors = _COLOR_OFFSETS[point_format]
    if colors is not None:
        names = ("red", "green", "blue")
        fields += [(name, "<u2", colors + 2 * k) for k, name in enumerate(names)]
    extra, more = _extra_dimensions(extra_bytes, _SIZES[point_format], length)
    fields += more
    field_names, formats, offsets = zip(*fields, strict=True)
    layout = np.dtype(
        {
            "names": list(field_names),
            "formats": list(formats),
            "offsets": list(offsets),
            "itemsize": length,
        }
    )
    numbers = np.array(struct.unpack_from("<6d", head, 131))
    return LasHeader(
        point_format,
        layout,
        begin,
        count,
        numbers[:3],
        numbers[3:],
        extra,
        packing,
        bool(kind & _COMPRESSED),
    )


def _records(
    path: str, file: BinaryIO, begin: int, count: int, end: int
) -> Iterator[tuple[bytes, int, bytes]]:
    """Yields owner, number and contents of each record between header and points."""
    file.seek(begin)
    for _ in range(count):
        head = file.read(_RECORD_HEAD)
        if len(head) < _RECORD_HEAD:
            raise ValueError(f"'{path}': too short for the records that its header announces")
        user, number, size = struct.unpack_from("<2x16sHH", head)
        # Some programs announce more records than they write.
        if file.tell() + size > end:
            return
        yield user.split(b"\0")[0], number, file.read(size)


def _end_of_records(file: BinaryIO, head: bytes, size: int) -> int:
    """End of the extended records of LAS 1.4, or of the first one that is cut off."""
    if len(head) < 247 or head[25] < 4:
        return 0
    begin, count = struct.unpack_from("<QI", head, 235)
    end: int = begin if count else 0
    for _ in range(count):
        if end + 60 > size:
            return end + 60
        file.seek(end + 20)
        end += 60 + struct.unpack("<Q", file.read(8))[0]
    return end


def _extra_dimensions(
    data: bytes, begin: int, end: int
) -> tuple[list[ExtraDimension], list[tuple[str, str, int]]]:
    """Extra dimensions in a record of extra bytes, and their fields within [begin, end).

    Dimensions of several numbers, and bytes without a description, are skipped.
    """
    dimensions: list[ExtraDimension] = []
    fields: list[tuple[str, str, int]] = []
    position = begin
    for at in range(0, len(data) - _EXTRA_BYTES + 1, _EXTRA_BYTES):
        kind, options = data[at + 2], data[at + 3]
        if kind == 0:
            position += options
            continue
        if kind > 3 * len(_EXTRA_TYPES):
            break  # The size of an unknown type is unknown, and so is the next position.
        number, repeats = (kind - 1) % len(_EXTRA_TYPES), (kind - 1) // len(_EXTRA_TYPES) + 1
        code = _EXTRA_TYPES[number]
        width = np.dtype(code).itemsize * repeats
        if position + width > end:
            break
        if repeats == 1:
            name = data[at + 4 : at + 36].split(b"\0")[0].decode("utf-8", "backslashreplace")
            scale = struct.unpack_from("<d", data, at + 112)[0] if options & 8 else 1.0
            offset = struct.unpack_from("<d", data, at + 136)[0] if options & 16 else 0.0
            field = f"extra {len(dimensions)}"
            dimensions.append(ExtraDimension(name, field, scale, offset))
            fields.append((field, code, position))
        position += width
    return dimensions, fields
