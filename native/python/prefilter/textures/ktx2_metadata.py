# SPDX-License-Identifier: GPL-3.0-or-later

"""Metadata of KTX 2.0 files, and access to parts of them."""

import os
import struct

from .._border.input import as_path, open_file

IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
HEADER = struct.Struct("<9I4I2Q")
_MOST_METADATA = 1 << 20


class RefusedError(ValueError):
    """A refusal whose message continues after the name of the file."""


def read_metadata(path: str | os.PathLike[str]) -> dict[str, str]:
    """Reads only the key-value metadata of a KTX 2.0 file.

    Raises:
        ValueError: The file is no KTX 2 file, or damaged.
        OSError: The file cannot be read.
    """
    source = as_path(path)
    with open_file(source) as file:
        head = file.read(len(IDENTIFIER) + HEADER.size)
        try:
            if not head.startswith(IDENTIFIER):
                raise ValueError("no KTX 2 file")
            at, size = HEADER.unpack_from(head, len(IDENTIFIER))[11:13]
            file.seek(at)
            return metadata_of(file.read(min(size, _MOST_METADATA)))
        except (ValueError, struct.error) as error:
            raise ValueError(f"path: '{source}' is damaged: {error}") from error


def metadata_of(data: bytes) -> dict[str, str]:
    metadata: dict[str, str] = {}
    at = 0
    while at + 4 <= min(len(data), _MOST_METADATA):
        (size,) = struct.unpack_from("<I", data, at)
        key, _, value = part_of(data, at + 4, size).partition(b"\0")
        metadata[key.decode("utf-8", "replace")] = value.rstrip(b"\0").decode("utf-8", "replace")
        at += 4 + size + -size % 4
    return metadata


def part_of(data: bytes, start: int, size: int) -> bytes:
    if start + size > len(data):
        raise RefusedError(
            f"ends after {len(data)} bytes; what it refers to ends after {start + size}"
        )
    return data[start : start + size]
