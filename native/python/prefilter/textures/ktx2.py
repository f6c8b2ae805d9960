# SPDX-License-Identifier: GPL-3.0-or-later

"""The KTX 2.0 container, and its basic data format descriptor (Khronos Data Format 1.3)."""

import math
import struct
from collections.abc import Iterator, Mapping

import numpy as np

from .._native import VERSION
from .texel_formats import ALPHA, Container, Texture

_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
_HEADER_BYTES, _LEVEL_INDEX_BYTES = 80, 24
_SHARED_ALIGNMENT = 8
_BASIC_FORMAT_VERSION = 2
_PRIMARIES_UNSPECIFIED, _PRIMARIES_BT709 = 0, 1
_TRANSFER_LINEAR, _TRANSFER_SRGB = 1, 2
_FLAG_PREMULTIPLIED = 1
_LINEAR, _SIGNED, _FLOAT = 0x10, 0x40, 0x80
_SCHEMES = {"none": 0, "basislz": 1, "zstd": 2}


def _parts(texture: Texture) -> Iterator[bytes]:
    descriptor = _descriptor(texture)
    # Rows from the top, as most tools expect.
    own = (("KTXorientation", "rd"), ("KTXwriter", f"prefilter {VERSION}"))
    metadata = b"".join(
        _entry(key, value)
        for key, value in sorted((*own, *texture.metadata), key=lambda entry: entry[0].encode())
    )
    descriptor_offset = _HEADER_BYTES + _LEVEL_INDEX_BYTES * len(texture.levels)
    metadata_offset = descriptor_offset + len(descriptor)
    end = metadata_offset + len(metadata)

    scheme = _SCHEMES[texture.supercompression]
    alignment = 1 if scheme else math.lcm(texture.texel_format.unit_bytes, 4)
    index: list[bytes] = []
    shared_offset, data = 0, [b""]
    if texture.shared:
        data = [bytes(-end % _SHARED_ALIGNMENT), texture.shared]
        shared_offset = end + len(data[0])
        end = shared_offset + len(texture.shared)
    for level, level_bytes in zip(
        reversed(texture.levels), reversed(texture.level_bytes), strict=True
    ):
        data.append(bytes(-end % alignment))
        end += len(data[-1])
        index.append(struct.pack("<3Q", end, len(level), level_bytes))
        data.append(level)
        end += len(level)

    yield _IDENTIFIER
    channel_type = np.uint8 if texture.texel_format.is_block else texture.texel_format.channel_type
    channel_bytes = np.dtype(channel_type).itemsize
    counts = (0, 0, 1, len(texture.levels), scheme)  # Depth, layers and faces come first.
    yield struct.pack("<9I", texture.code, channel_bytes, texture.width, texture.height, *counts)
    yield struct.pack("<4I", descriptor_offset, len(descriptor), metadata_offset, len(metadata))
    yield struct.pack("<2Q", shared_offset, len(texture.shared))
    yield from reversed(index)
    yield descriptor
    yield metadata
    yield from data


def _descriptor(texture: Texture) -> bytes:
    texel_format = texture.texel_format
    samples = b"".join(_samples(texture))
    size = 24 + len(samples)
    model, _ = texel_format.khronos
    columns, rows = texel_format.block or (1, 1)
    planes = [texel_format.unit_bytes, 0]
    if texel_format.is_shared and texture.alpha is not None:
        planes[1] = texel_format.unit_bytes
    return (
        struct.pack("<I2I", 4 + size, 0, size << 16 | _BASIC_FORMAT_VERSION)
        + struct.pack(
            "<4B",
            model,
            _primaries(texture),
            _TRANSFER_SRGB if texture.is_srgb else _TRANSFER_LINEAR,
            _FLAG_PREMULTIPLIED if texture.alpha == "premultiplied" else 0,
        )
        + struct.pack("<4B", columns - 1, rows - 1, 0, 0)
        + struct.pack("<8B", *planes, *(0,) * 6)
        + samples
    )


def _primaries(texture: Texture) -> int:
    # KHR_texture_basisu of glTF: textures other than color have no primaries.
    is_data = texture.texel_format.is_transcoded and not texture.is_srgb
    return _PRIMARIES_UNSPECIFIED if is_data else _PRIMARIES_BT709


def _samples(texture: Texture) -> Iterator[bytes]:
    texel_format = texture.texel_format
    _, channels = texel_format.khronos
    if texture.alpha is None:
        channels = texel_format.opaque_khronos or channels
    planes = len(channels) if texel_format.is_shared else 1
    bits = 8 * texel_format.unit_bytes * planes // len(channels)
    for number, channel in enumerate(channels):
        if texel_format.is_float:
            qualifiers = _FLOAT | (_SIGNED if texel_format.has_sign else 0)
            limits = struct.pack("<2f", -1.0 if texel_format.has_sign else 0.0, 1.0)
        else:
            qualifiers = _LINEAR if channel == ALPHA and texture.is_srgb else 0
            limits = struct.pack("<2I", 0, (1 << min(bits, 32)) - 1)
        yield struct.pack("<H2B4x", bits * number, bits - 1, channel | qualifiers) + limits


def _entry(key: str, value: str) -> bytes:
    text = f"{key}\0{value}\0".encode()
    return struct.pack("<I", len(text)) + text + bytes(-len(text) % 4)


def as_metadata(metadata: Mapping[str, str] | None) -> tuple[tuple[str, str], ...]:
    """Returns the checked argument as key-value pairs."""
    if metadata is None:
        return ()
    if not isinstance(metadata, Mapping):
        raise ValueError(f"metadata: {metadata!r}; texts by keys are needed")
    for key, value in metadata.items():
        if not (isinstance(key, str) and isinstance(value, str)):
            raise ValueError(f"metadata: {key!r}: {value!r}; texts by keys are needed")
        if not key or key.startswith("KTX") or "\0" in key + value:
            raise ValueError(
                f"metadata: {key!r}; keys that do not begin with KTX, and no null characters, are "
                f"needed"
            )
    return tuple(metadata.items())


KTX2 = Container("KTX 2", lambda texel_format: texel_format.vulkan, _parts)
