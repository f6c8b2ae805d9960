# SPDX-License-Identifier: GPL-3.0-or-later

"""The DDS container: Microsoft's programming guide for DDS, with the DX10 header extension."""

import struct
from collections.abc import Iterator

from .texel_formats import Container, Texture

_CAPS, _HEIGHT, _WIDTH, _PITCH = 0x1, 0x2, 0x4, 0x8
_PIXEL_FORMAT, _MIPMAP_COUNT, _LINEAR_SIZE = 0x1000, 0x20000, 0x80000
_FOUR_CC = 0x4
_CAPS_TEXTURE, _CAPS_COMPLEX, _CAPS_MIPMAP = 0x1000, 0x8, 0x400000
_TEXTURE_2D = 3
_ALPHA_MODES = {"straight": 1, "premultiplied": 2, None: 3, "independent": 4}


def _parts(texture: Texture) -> Iterator[bytes]:
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
    yield struct.pack("<2I4s20x", 32, _FOUR_CC, b"DX10")
    yield struct.pack("<I16x", caps)
    yield struct.pack("<5I", texture.code, _TEXTURE_2D, 0, 1, _ALPHA_MODES[texture.alpha])
    yield from texture.levels


DDS = Container("DDS", lambda texel_format: texel_format.dxgi, _parts)
