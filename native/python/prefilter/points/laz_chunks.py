# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of a LAZ file's chunks before lazrs decompresses them.

lazrs allocates as much memory as the file announces, and aborts the process if a damaged file
announces too much. The checks follow the LAZ specification: the record "laszip encoded", the chunk
table, and the heads of layered chunks.
"""

import os
import struct
from collections.abc import Sequence
from typing import Any, BinaryIO, NamedTuple

from .._border.input import open_file
from .las_header import LasHeader

_VARIABLE_SIZE = 0xFFFFFFFF
_MAX_CHUNK_POINTS = 1 << 22
"""Largest chunk that is read, in points, as lazrs holds a chunk in memory; writers use 50,000."""
_POINTWISE_CHUNKED, _LAYERED_CHUNKED = 2, 3
_LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}
"""Number of layers of an item of a point, by type; an item of type 14 has one per byte."""


class _Record(NamedTuple):
    """LASzip's record: how points are compressed."""

    compressor: int
    chunk_size: int
    point_size: int
    layers: int


def check_chunks(path: str, header: LasHeader, backend: Any) -> None:
    """Checks the chunks of a LAZ file against its header and tables.

    Args:
        path: Path of the file.
        header: Header of the file.
        backend: The module lazrs.

    Raises:
        ValueError: They do not agree.
    """
    data = header.packing
    if data is None:
        raise ValueError(f"'{path}': compressed, and the record that says how is missing")
    record = _record(path, data)
    if record.point_size != header.layout.itemsize:
        raise ValueError(
            f"'{path}': its compressed points have {record.point_size} bytes, and those of its "
            f"header {header.layout.itemsize}"
        )
    if header.count == 0:
        return
    begin = header.begin
    with open_file(path) as file:
        table = _table_offset(path, file, begin)
        count = _chunk_count(path, file, table, begin, record.point_size)
        file.seek(begin)
        chunks = backend.read_chunk_table(file, backend.LazVlr(data))
        if len(chunks) != count:
            raise ValueError(f"'{path}': has {len(chunks)} of the {count} chunks of its table")
        _check_counts(path, chunks, record, header.count)
        _check_sizes(path, file, chunks, record, begin + 8, table)


def _record(path: str, data: bytes) -> _Record:
    try:
        compressor, chunk_size, items = struct.unpack_from("<H10xI16xH", data)
        parts = [struct.unpack_from("<HHH", data, 34 + 6 * i) for i in range(items)]
    except struct.error as error:
        raise ValueError(f"'{path}': the record of its compression is cut off") from error
    if compressor not in (_POINTWISE_CHUNKED, _LAYERED_CHUNKED):
        raise ValueError(
            f"'{path}': compressor {compressor} is not one of {_POINTWISE_CHUNKED}, "
            f"{_LAYERED_CHUNKED}"
        )
    layers = sum(size if kind == 14 else _LAYERS.get(kind, 0) for kind, size, _ in parts)
    return _Record(compressor, chunk_size, sum(size for _, size, _ in parts), layers)


def _table_offset(path: str, file: BinaryIO, begin: int) -> int:
    """Offset of the chunk table, stored before the points or, by streaming writers, at the end."""
    end = file.seek(0, os.SEEK_END)
    for position in (begin, end - 8):
        if begin + 8 <= position + 8 <= end:
            file.seek(position)
            offset: int = struct.unpack("<q", file.read(8))[0]
            if begin < offset:
                break
    else:
        raise ValueError(f"'{path}': has no table of its chunks")
    if not begin + 8 <= offset <= end - 8:
        raise ValueError(
            f"'{path}': its chunks are at {begin + 8}, their table at {offset}, and it has {end} "
            "bytes"
        )
    return offset


def _chunk_count(path: str, file: BinaryIO, table: int, begin: int, point_size: int) -> int:
    file.seek(table)
    count: int = struct.unpack("<4xI", file.read(8))[0]
    # The first point of each chunk is not compressed.
    room = table - begin - 8
    if count * point_size > room:
        raise ValueError(f"'{path}': too short for the {count} chunks of its table: {room} bytes")
    return count


def _check_counts(
    path: str, chunks: Sequence[tuple[int, int]], record: _Record, points: int
) -> None:
    """Checks the number of points of each chunk, and of all chunks."""
    counts = [count for count, _ in chunks]
    if max(counts, default=0) > _MAX_CHUNK_POINTS:
        raise ValueError(
            f"'{path}': a chunk of {max(counts)} points; at most {_MAX_CHUNK_POINTS} are read"
        )
    total = sum(counts)
    spare = 0 if record.chunk_size == _VARIABLE_SIZE else record.chunk_size - 1
    if not total - spare <= points <= total:
        raise ValueError(f"'{path}': chunks of {total} points for the {points} in its header")


def _check_sizes(
    path: str,
    file: BinaryIO,
    chunks: Sequence[tuple[int, int]],
    record: _Record,
    begin: int,
    end: int,
) -> None:
    """Checks that no chunk, and no layer of a chunk, exceeds the bytes available."""
    head = struct.Struct(f"<{record.point_size}xI{record.layers}I")
    least = head.size if record.compressor == _LAYERED_CHUNKED else record.point_size
    for number, (_, size) in enumerate(chunks):
        if not least <= size <= end - begin:
            raise ValueError(
                f"'{path}': chunk {number} has {size} bytes; at least {least} and at most the "
                f"{end - begin} that are left are needed"
            )
        if record.compressor == _LAYERED_CHUNKED:
            file.seek(begin)
            _, *layers = head.unpack(file.read(head.size))
            if head.size + sum(layers) > size:
                raise ValueError(
                    f"'{path}': chunk {number} has {size} bytes, and its layers {sum(layers)}"
                )
        begin += size
