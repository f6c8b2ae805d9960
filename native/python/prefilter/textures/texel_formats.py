# SPDX-License-Identifier: GPL-3.0-or-later

"""Table of the texel formats of texture files for engines."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .. import _native

Channel = type[np.uint8] | type[np.float16] | type[np.float32]
Codes = tuple[int | None, int | None]
"""A container's codes for a format with linear and with sRGB colors; None if it has no code."""


@dataclass(frozen=True)
class TexelFormat:
    """A layout of texels, and its codes in the containers.

    Attributes:
        name: The name that `write_dds` and `write_ktx2` take.
        channels: Number of channels of a texel.
        unit_bytes: Bytes of a texel, or of a block of texels.
        block: Columns and rows of a compressed block; None if texels are not compressed.
        channel_type: Type of a channel; for blocks, of the uncompressed texels.
        dxgi: The DXGI_FORMAT for linear and for sRGB colors; None if there is none.
        vulkan: The VkFormat for linear and for sRGB colors; None if there is none.
        khronos: The color model of Khronos' data format descriptor, and its channels, which have
            equally many bits.
        opaque_khronos: The channels for textures without alpha, if they differ.
        alpha: "full", "cut-out" (0 or 1), or "none".
        has_sign: Whether its type has negative values; see `keeps_negatives`.
        is_coarse: Whether colors in a block are rounded to 4 to 6 bits per channel.
        is_shared: Whether all levels share codebooks, and are thus compressed together.
    """

    name: str
    channels: int
    unit_bytes: int
    block: tuple[int, int] | None
    channel_type: Channel
    dxgi: Codes
    vulkan: Codes
    khronos: tuple[int, tuple[int, ...]]
    opaque_khronos: tuple[int, ...] | None = None
    alpha: str = "none"
    has_sign: bool = False
    is_coarse: bool = False
    is_shared: bool = False

    @property
    def texel_bytes(self) -> float:
        """Bytes of a texel, averaged over a block."""
        columns, rows = self.block or (1, 1)
        return self.unit_bytes / (columns * rows)

    @property
    def is_block(self) -> bool:
        return self.block is not None

    @property
    def is_float(self) -> bool:
        return self.channel_type is not np.uint8

    @property
    def is_in_dds(self) -> bool:
        """Whether DDS files support it; KTX 2 files support all."""
        return self.dxgi != (None, None)

    @property
    def is_transcoded(self) -> bool:
        """Whether loaders transcode it to another format, so that Vulkan has no code for it."""
        return self.vulkan[0] == _UNDEFINED

    @property
    def keeps_negatives(self) -> bool:
        """Whether negative values are preserved; in blocks of floats they become 0."""
        return self.has_sign and not self.is_block


@dataclass(frozen=True)
class Texture:
    """The contents of a container file.

    Attributes:
        texel_format: The format of every level.
        code: The container's code for it.
        is_srgb: Whether its colors are sRGB-encoded.
        width: Width of level 0, in texels.
        height: Height of level 0, in texels.
        levels: Texels or blocks of each level, level 0 first, the top row first.
        alpha: Meaning of the fourth channel: one of `ALPHAS`; None if there is none.
        supercompression: Additional compression of the levels, one of `SUPERCOMPRESSIONS`.
        level_bytes: Size of each level before that; 0 if readers do not need it.
        shared: Global data of all levels, for BasisLZ.
        metadata: Key-value pairs to store, if the container supports that.
    """

    texel_format: TexelFormat
    code: int
    is_srgb: bool
    width: int
    height: int
    levels: list[bytes]
    alpha: str | None
    supercompression: str = "none"
    level_bytes: tuple[int, ...] = ()
    shared: bytes = b""
    metadata: tuple[tuple[str, str], ...] = ()


class Container(NamedTuple):
    """A file format."""

    name: str
    codes: Callable[[TexelFormat], Codes]
    parts: Callable[[Texture], Iterator[bytes]]
    """Yields the file in pieces."""


ALPHAS = ("straight", "premultiplied", "independent")
SUPERCOMPRESSIONS = ("none", "zstd")
EFFORTS = ("fast", "normal", "best")

RED, GREEN, BLUE, ALPHA = 0, 1, 2, 15
"""Channel numbers of Khronos, for texels and for blocks of one or two channels."""
_COLOR, _COLOR_AND_CUT_OUT, _ETC2_COLOR = 0, 1, 2
_UASTC_RGB, _UASTC_RGBA = 0, 3
_RGBSDA, _ETC2, _ASTC, _ETC1S, _UASTC = 1, 161, 162, 163, 166
_BC1, _BC3, _BC4, _BC5, _BC6H, _BC7 = 128, 130, 131, 132, 133, 134
_UNDEFINED = 0
_NONE = (None, None)


def _plain(
    name: str, channels: int, channel_type: Channel, dxgi: Codes, vulkan: Codes
) -> TexelFormat:
    return TexelFormat(
        name,
        channels,
        channels * np.dtype(channel_type).itemsize,
        None,
        channel_type,
        dxgi,
        vulkan,
        (_RGBSDA, (RED, GREEN, BLUE, ALPHA)[:channels]),
        alpha="full" if channels == 4 else "none",
        has_sign=channel_type is not np.uint8,
    )


_LAYOUTS = _native.block_layouts()


def _blocks(
    name: str,
    channels: int,
    dxgi: Codes,
    vulkan: Codes,
    model: int,
    *khronos: int,
    opaque_khronos: tuple[int, ...] | None = None,
    alpha: str = "",
    has_sign: bool = False,
    is_coarse: bool = False,
) -> TexelFormat:
    columns, rows, unit_bytes, is_float = _LAYOUTS[name]
    return TexelFormat(
        name,
        channels,
        unit_bytes,
        (columns, rows),
        np.float16 if is_float else np.uint8,
        dxgi,
        vulkan,
        (model, khronos),
        opaque_khronos,
        alpha or ("full" if channels == 4 else "none"),
        has_sign,
        is_coarse,
    )


def _astc(name: str, vulkan: Codes) -> TexelFormat:
    is_float = _LAYOUTS[name][3]
    return _blocks(name, 4, _NONE, vulkan, _ASTC, _COLOR, has_sign=is_float)


TEXEL_FORMATS = {
    texel_format.name: texel_format
    for texel_format in (
        _plain("r8", 1, np.uint8, (61, None), (9, 15)),
        _plain("rg8", 2, np.uint8, (49, None), (16, 22)),
        _plain("rgba8", 4, np.uint8, (28, 29), (37, 43)),
        _plain("rgba16f", 4, np.float16, (10, None), (97, None)),
        _plain("rgba32f", 4, np.float32, (2, None), (109, None)),
        _blocks(
            *("bc1", 4, (71, 72), (133, 134), _BC1, _COLOR_AND_CUT_OUT),
            alpha="cut-out",
            is_coarse=True,
        ),
        _blocks("bc1-rgb", 3, (71, 72), (131, 132), _BC1, _COLOR, is_coarse=True),
        _blocks("bc3", 4, (77, 78), (137, 138), _BC3, ALPHA, _COLOR, is_coarse=True),
        _blocks("bc4", 1, (80, None), (139, None), _BC4, RED),
        _blocks("bc5", 2, (83, None), (141, None), _BC5, RED, GREEN),
        _blocks("bc6h", 3, (95, None), (143, None), _BC6H, _COLOR),
        _blocks("bc7", 4, (98, 99), (145, 146), _BC7, _COLOR),
        _blocks("etc2-rgb", 3, _NONE, (147, 148), _ETC2, _ETC2_COLOR, is_coarse=True),
        _blocks("etc2-rgba", 4, _NONE, (151, 152), _ETC2, ALPHA, _ETC2_COLOR, is_coarse=True),
        _blocks("eac-r11", 1, _NONE, (153, None), _ETC2, RED),
        _blocks("eac-rg11", 2, _NONE, (155, None), _ETC2, RED, GREEN),
        _astc("astc-4x4", (157, 158)),
        _astc("astc-6x6", (165, 166)),
        _astc("astc-8x8", (171, 172)),
        _astc("astc-4x4-hdr", (1000066000, None)),
        _astc("astc-6x6-hdr", (1000066004, None)),
        _blocks(
            *("uastc", 4, _NONE, (_UNDEFINED, _UNDEFINED), _UASTC, _UASTC_RGBA),
            opaque_khronos=(_UASTC_RGB,),
        ),
        TexelFormat(
            *("etc1s", 4, 8, (4, 4), np.uint8, _NONE, (_UNDEFINED, _UNDEFINED)),
            (_ETC1S, (_COLOR, ALPHA)),
            opaque_khronos=(_COLOR,),
            alpha="full",
            is_coarse=True,
            is_shared=True,
        ),
    )
}
"""All formats, by name."""
