# SPDX-License-Identifier: GPL-3.0-or-later

"""The DDS container, after Microsoft's programming guide for DDS, with both kinds of header.

The Direct3D 9 header describes the layout by a code or masks, and cannot express sRGB. The
Direct3D 10 extension expresses everything, but older readers reject it, so it is added only where
information would be lost.
"""

import struct
from collections.abc import Iterator
from functools import partial

import numpy as np

from .texel_formats import Codes, Container, TexelFormat, Texture

HEADERS = ("auto", "legacy", "dx10")

_CAPS, _HEIGHT, _WIDTH, _PITCH = 0x1, 0x2, 0x4, 0x8
_PIXEL_FORMAT, _MIPMAP_COUNT, _LINEAR_SIZE = 0x1000, 0x20000, 0x80000
_HAS_ALPHA, _FOUR_CC, _RGB, _LUMINANCE = 0x1, 0x4, 0x40, 0x20000
_CAPS_TEXTURE, _CAPS_COMPLEX, _CAPS_MIPMAP = 0x1000, 0x8, 0x400000
_TEXTURE_2D = 3
_ALPHA_MODES = {"straight": 1, "premultiplied": 2, None: 3, "independent": 4}

_DX10 = struct.pack("<2I4s20x", 32, _FOUR_CC, b"DX10")
_HALF_FLOATS, _FLOATS = struct.pack("<I", 113), struct.pack("<I", 116)  # Direct3D 9 format codes.
_FOUR_CCS = {
    "bc1": b"DXT1",
    "bc1-rgb": b"DXT1",
    "bc3": b"DXT5",
    "bc4": b"ATI1",
    "bc5": b"ATI2",
    "rgba16f": _HALF_FLOATS,
    "rgba32f": _FLOATS,
}
_MASKS = {
    "r8": (_LUMINANCE, 8, 0xFF, 0, 0, 0),
    # Byte order of Direct3D 9, B8G8R8A8; few readers support others.
    "rgba8": (_RGB, 32, 0xFF0000, 0xFF00, 0xFF, 0xFF000000),
}
_SWAPPED = [2, 1, 0, 3]


def container(header: str) -> Container:
    """Returns DDS with one of `HEADERS`; "auto" uses the legacy one if it loses nothing."""
    if header == "legacy":
        return Container("legacy DDS", _legacy_codes, partial(_parts, header=header))
    return Container("DDS", lambda texel_format: texel_format.dxgi, partial(_parts, header=header))


def _legacy_codes(texel_format: TexelFormat) -> Codes:
    if texel_format.name not in _FOUR_CCS | _MASKS:
        return None, None
    return texel_format.dxgi


def _parts(texture: Texture, *, header: str) -> Iterator[bytes]:
    is_legacy = header == "legacy" or (header == "auto" and _legacy_suffices(texture))
    flags = _CAPS | _HEIGHT | _WIDTH | _PIXEL_FORMAT
    caps = _CAPS_TEXTURE
    if len(texture.levels) > 1:
        flags |= _MIPMAP_COUNT
        caps |= _CAPS_COMPLEX | _CAPS_MIPMAP
    if texture.texel_format.is_block:
        flags |= _LINEAR_SIZE
        pitch_or_size = len(texture.levels[0])
    else:
        flags |= _PITCH
        pitch_or_size = texture.width * texture.texel_format.unit_bytes
    yield b"DDS "
    yield struct.pack(
        "<7I44x",
        124,
        flags,
        texture.height,
        texture.width,
        pitch_or_size,
        0,
        len(texture.levels),
    )
    yield _legacy_pixel_format(texture) if is_legacy else _DX10
    yield struct.pack("<I16x", caps)
    if is_legacy:
        yield from _legacy_levels(texture)
        return
    yield struct.pack("<5I", texture.code, _TEXTURE_2D, 0, 1, _ALPHA_MODES[texture.alpha])
    yield from texture.levels


def _legacy_suffices(texture: Texture) -> bool:
    """Whether the legacy header, which more programs read, loses nothing."""
    texel_format = texture.texel_format
    # Luminance is not the same as red, and Rust's readers do not support it.
    is_known = texel_format.name in _FOUR_CCS | _MASKS and texel_format.name != "r8"
    is_plain = not texture.is_srgb and texture.alpha in ("straight", None)
    return is_known and is_plain and not texel_format.is_float


def _legacy_pixel_format(texture: Texture) -> bytes:
    name = texture.texel_format.name
    has_alpha = _HAS_ALPHA if texture.alpha is not None else 0
    if name in _FOUR_CCS:
        return struct.pack("<2I4s20x", 32, _FOUR_CC | has_alpha, _FOUR_CCS[name])
    kind, bits, *masks = _MASKS[name]
    if not has_alpha:
        masks[3] = 0
    return struct.pack("<2I4x5I", 32, kind | has_alpha, bits, *masks)


def _legacy_levels(texture: Texture) -> Iterator[bytes]:
    if texture.texel_format.name != "rgba8":
        yield from texture.levels
        return
    for level in texture.levels:
        yield np.frombuffer(level, np.uint8).reshape(-1, 4)[:, _SWAPPED].tobytes()
