# SPDX-License-Identifier: GPL-3.0-or-later

"""The KTX 2.0 container, and its basic data format descriptor (Khronos Data Format 1.3)."""

import math
import struct
from collections.abc import Iterator

import numpy as np

from .._native import VERSION
from .texel_formats import FORMATS, Container, Texture

_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
_HEADER_BYTES, _LEVEL_INDEX_BYTES = 80, 24
_BASIC_FORMAT_VERSION = 2
_MODEL_RGBSDA = 1
_PRIMARIES_UNSPECIFIED, _PRIMARIES_BT709 = 0, 1
_TRANSFER_LINEAR, _TRANSFER_SRGB = 1, 2
_FLAG_PREMULTIPLIED = 1
_RED, _GREEN, _BLUE, _ALPHA = 0, 1, 2, 15
_BLOCK_COLOR, _BLOCK_COLOR_AND_CUT_OUT = 0, 1
_ETC2_COLOR = 2
_UASTC_RGB, _UASTC_RGBA = 0, 3
_BLOCKS = {
    "bc1": (128, (_BLOCK_COLOR_AND_CUT_OUT,)),
    "bc1-rgb": (128, (_BLOCK_COLOR,)),
    "bc3": (130, (_ALPHA, _BLOCK_COLOR)),
    "bc4": (131, (_RED,)),
    "bc5": (132, (_RED, _GREEN)),
    "bc6h": (133, (_BLOCK_COLOR,)),
    "bc7": (134, (_BLOCK_COLOR,)),
    "etc2-rgb": (161, (_ETC2_COLOR,)),
    "etc2-rgba": (161, (_ALPHA, _ETC2_COLOR)),
    "eac-r11": (161, (_RED,)),
    "eac-rg11": (161, (_RED, _GREEN)),
    **{name: (162, (_BLOCK_COLOR,)) for name in FORMATS if name.startswith("astc")},
    "uastc": (166, (_UASTC_RGBA,)),
}
"""Block formats: their color model and their channels, which have the same number of bits."""
_LINEAR, _SIGNED, _FLOAT = 0x10, 0x40, 0x80
_SCHEMES = {"none": 0, "zstd": 2}


def _parts(texture: Texture) -> Iterator[bytes]:
    descriptor = _descriptor(texture)
    # Sorted by key, as it has to be. Rows go down, as most tools have them.
    metadata = _entry("KTXorientation", "rd") + _entry("KTXwriter", f"prefilter {VERSION}")
    descriptor_offset = _HEADER_BYTES + _LEVEL_INDEX_BYTES * len(texture.levels)
    metadata_offset = descriptor_offset + len(descriptor)
    end = metadata_offset + len(metadata)

    scheme = _SCHEMES[texture.supercompression]
    alignment = 1 if scheme else math.lcm(texture.texel_format.unit_bytes, 4)
    index: list[bytes] = []
    data: list[bytes] = []
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
    counts = (0, 0, 1, len(texture.levels), scheme)  # the first are depth, layers and faces
    yield struct.pack("<9I", texture.code, channel_bytes, texture.width, texture.height, *counts)
    yield struct.pack(
        "<4I2Q", descriptor_offset, len(descriptor), metadata_offset, len(metadata), 0, 0
    )
    yield from reversed(index)
    yield descriptor
    yield metadata
    yield from data


def _descriptor(texture: Texture) -> bytes:
    texel_format = texture.texel_format
    samples = b"".join(_samples(texture))
    size = 24 + len(samples)
    model, _ = _model_and_channels(texture)
    columns, rows = texel_format.block or (1, 1)
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
        + struct.pack("<8B", texel_format.unit_bytes, *(0,) * 7)
        + samples
    )


def _primaries(texture: Texture) -> int:
    # KHR_texture_basisu of glTF: of what is no color, UASTC has none.
    is_data = texture.texel_format.name == "uastc" and not texture.is_srgb
    return _PRIMARIES_UNSPECIFIED if is_data else _PRIMARIES_BT709


def _model_and_channels(texture: Texture) -> tuple[int, tuple[int, ...]]:
    texel_format = texture.texel_format
    if texel_format.name == "uastc" and texture.alpha is None:
        return _BLOCKS["uastc"][0], (_UASTC_RGB,)
    if texel_format.is_block:
        return _BLOCKS[texel_format.name]
    return _MODEL_RGBSDA, (_RED, _GREEN, _BLUE, _ALPHA)[: texel_format.channels]


def _samples(texture: Texture) -> Iterator[bytes]:
    texel_format = texture.texel_format
    _, channels = _model_and_channels(texture)
    bits = 8 * texel_format.unit_bytes // len(channels)
    for number, channel in enumerate(channels):
        if texel_format.is_float:
            has_sign = texel_format.name != "bc6h"
            channel |= _FLOAT | (_SIGNED if has_sign else 0)
            limits = struct.pack("<2f", -1.0 if has_sign else 0.0, 1.0)
        else:
            if channel == _ALPHA and texture.is_srgb:
                channel |= _LINEAR
            limits = struct.pack("<2I", 0, (1 << min(bits, 32)) - 1)
        yield struct.pack("<H2B4x", bits * number, bits - 1, channel) + limits


def _entry(key: str, value: str) -> bytes:
    text = f"{key}\0{value}\0".encode()
    return struct.pack("<I", len(text)) + text + bytes(-len(text) % 4)


KTX2 = Container("KTX 2", lambda texel_format: texel_format.vulkan, _parts)
