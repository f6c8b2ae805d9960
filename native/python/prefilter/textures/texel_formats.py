# SPDX-License-Identifier: GPL-3.0-or-later

"""How the texels of texture files for engines are laid out, and arrays brought into that layout."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_one_of
from .._border.arrays import as_image, as_texels
from ..images.color import to_linear

Codes = tuple[int | None, int | None]
"""What a container calls a format with linear and with sRGB colors; None where it has no word."""


@dataclass(frozen=True)
class TexelFormat:
    """A layout of texels, and what the containers call it.

    Attributes:
        name: As `write_dds` and `write_ktx2` take it.
        channels: How many a texel has.
        unit_bytes: Of a texel, or of a block of texels.
        block: The columns and rows of a block that is compressed; None where texels are not.
        channel_type: Of a channel; of what is compressed for blocks.
        dxgi: The DXGI_FORMAT of linear and of sRGB colors; None where there is none.
        vulkan: The VkFormat of the same.
    """

    name: str
    channels: int
    unit_bytes: int
    block: tuple[int, int] | None
    channel_type: type[np.uint8] | type[np.float16] | type[np.float32]
    dxgi: Codes
    vulkan: Codes

    @property
    def is_block(self) -> bool:
        return self.block is not None

    @property
    def is_float(self) -> bool:
        return self.channel_type is not np.uint8


@dataclass(frozen=True)
class Texture:
    """What a container holds.

    Attributes:
        texel_format: Of every level.
        code: What the container calls it.
        is_srgb: Whether its colors are sRGB-encoded.
        width: Of level 0, in texels.
        height: Of level 0, in texels.
        levels: Their texels or blocks, level 0 first, the top row first.
        alpha: What the fourth channel is: one of `ALPHAS`; None where there is none.
        supercompression: How the levels are compressed once more, one of `SUPERCOMPRESSIONS`.
        level_bytes: How many each level had before that.
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


class Container(NamedTuple):
    """A kind of file."""

    name: str
    codes: Callable[[TexelFormat], Codes]
    parts: Callable[[Texture], Iterator[bytes]]
    """The file, piece by piece."""


def _plain(
    name: str,
    channels: int,
    channel_type: type[np.uint8] | type[np.float16] | type[np.float32],
    dxgi: Codes,
    vulkan: Codes,
) -> TexelFormat:
    size = channels * np.dtype(channel_type).itemsize
    return TexelFormat(name, channels, size, None, channel_type, dxgi, vulkan)


def _blocks(
    name: str,
    channels: int,
    unit_bytes: int,
    dxgi: Codes,
    vulkan: Codes,
    block: tuple[int, int] = (4, 4),
    channel_type: type[np.uint8] | type[np.float16] = np.uint8,
) -> TexelFormat:
    return TexelFormat(name, channels, unit_bytes, block, channel_type, dxgi, vulkan)


ALPHAS = ("straight", "premultiplied", "independent")
SUPERCOMPRESSIONS = ("none", "zstd")

FORMATS = {
    texel_format.name: texel_format
    for texel_format in (
        _plain("r8", 1, np.uint8, (61, None), (9, 15)),
        _plain("rg8", 2, np.uint8, (49, None), (16, 22)),
        _plain("rgba8", 4, np.uint8, (28, 29), (37, 43)),
        _plain("rgba16f", 4, np.float16, (10, None), (97, None)),
        _plain("rgba32f", 4, np.float32, (2, None), (109, None)),
        _blocks("bc1", 4, 8, (71, 72), (133, 134)),
        _blocks("bc1-rgb", 3, 8, (71, 72), (131, 132)),
        _blocks("bc3", 4, 16, (77, 78), (137, 138)),
        _blocks("bc4", 1, 8, (80, None), (139, None)),
        _blocks("bc5", 2, 16, (83, None), (141, None)),
        _blocks("bc6h", 3, 16, (95, None), (143, None), channel_type=np.float16),
        _blocks("bc7", 4, 16, (98, 99), (145, 146)),
        _blocks("etc2-rgb", 3, 8, (None, None), (147, 148)),
        _blocks("etc2-rgba", 4, 16, (None, None), (151, 152)),
        _blocks("eac-r11", 1, 8, (None, None), (153, None)),
        _blocks("eac-rg11", 2, 16, (None, None), (155, None)),
        _blocks("astc-4x4", 4, 16, (None, None), (157, 158)),
        _blocks("astc-6x6", 4, 16, (None, None), (165, 166), (6, 6)),
        _blocks("astc-8x8", 4, 16, (None, None), (171, 172), (8, 8)),
        _blocks("astc-4x4-hdr", 4, 16, (None, None), (1000066000, None), (4, 4), np.float16),
        _blocks("astc-6x6-hdr", 4, 16, (None, None), (1000066004, None), (6, 6), np.float16),
        # Of what it becomes where it is used, so Vulkan has no word for it: VK_FORMAT_UNDEFINED.
        _blocks("uastc", 4, 16, (None, None), (0, 0)),
    )
}


def halving_levels(levels: Sequence[npt.ArrayLike], srgb: bool) -> list[np.ndarray]:
    """The levels, each uint8 or float32; raises ValueError unless each halves the one before.

    Those of uint16 become floats, decoded where they are sRGB.
    """
    if not isinstance(levels, Sequence) or isinstance(levels, str | bytes) or not levels:
        found = "an empty list" if isinstance(levels, list) else f"a {type(levels).__name__}"
        raise ValueError(f"levels: {found}; a list of images, level 0 first, is needed")
    images: list[np.ndarray] = []
    for number, level in enumerate(levels):
        who = f"levels: level {number}"
        image = as_texels(who, level)
        if image.dtype == np.uint16:
            image = to_linear(image) if srgb else as_image(who, image)
        height, width, channels = image.shape
        if channels > 4:
            raise ValueError(f"{who} has {channels} channels; 1 to 4 are allowed")
        if images:
            before = images[-1].shape
            if before[:2] == (1, 1):
                raise ValueError(f"{who} is one too many: the one before has 1 x 1 texel")
            wanted = max(1, before[0] // 2), max(1, before[1] // 2)
            if (height, width) != wanted:
                raise ValueError(
                    f"{who} has {width} x {height} texels; half of the one before, rounded down, "
                    f"is {wanted[1]} x {wanted[0]}"
                )
            if channels != before[2]:
                raise ValueError(
                    f"{who} has {channels} channels, the one before {before[2]}; they must be alike"
                )
        images.append(image)
    return images


def as_levels(levels: Sequence[npt.ArrayLike], srgb: bool) -> list[np.ndarray]:
    """The same, all uint8 or all float32 and finite."""
    images = halving_levels(levels, srgb)
    for number, image in enumerate(images):
        who = f"levels: level {number}"
        if image.dtype != images[0].dtype:
            raise ValueError(
                f"{who} has texels of {image.dtype}, level 0 of {images[0].dtype}; they must be "
                "alike"
            )
        if image.dtype != np.uint8:
            _check_finite(who, image)
    return images


def as_format(name: str, level: np.ndarray, *, needs_srgb: bool) -> TexelFormat:
    """The format of that name; for "auto" the one that holds all of a level."""
    if name == "auto":
        if level.dtype != np.uint8:
            return FORMATS["rgba16f"]
        name = {1: "r8", 2: "rg8"}.get(level.shape[2], "rgba8")
        return FORMATS["rgba8" if needs_srgb else name]
    as_one_of("format", name, ("auto", *FORMATS))
    found = FORMATS[name]
    if found.channels == 2 and level.shape[2] < 2:
        raise ValueError(f"format: '{name}' needs 2 channels; the levels have {level.shape[2]}")
    return found


def encoded(
    level: np.ndarray,
    texel_format: TexelFormat,
    srgb: bool,
    *,
    weigh_by_alpha: bool,
    progress: ProgressCallback | None,
    threads: int,
) -> bytes:
    """A level as a file holds it, the top row first."""
    flipped = np.ascontiguousarray(level[::-1])
    if texel_format.is_float:
        texels = _linear_floats(flipped, srgb, texel_format, threads)
    elif flipped.dtype == np.uint8:
        texels = flipped
    else:
        texels = _native.to_bytes(flipped, srgb, threads)
    if texel_format.is_block:
        rgba = _with_channels(texels, 4)
        if texel_format.is_float:
            rgba = rgba.view(np.uint16)
        return _native.compress_blocks(
            rgba, texel_format.name, srgb, weigh_by_alpha, progress, threads
        )
    return _with_channels(texels, texel_format.channels).tobytes()


def _linear_floats(
    level: np.ndarray,
    srgb: bool,
    texel_format: TexelFormat,
    threads: int,
) -> np.ndarray:
    if level.dtype == np.uint8:
        level = level.astype(np.float32) / np.float32(255)
        if srgb:
            level = to_linear(level, threads=threads)
    with np.errstate(over="ignore"):
        values = level.astype(texel_format.channel_type)
    if not np.isfinite(values).all():
        raise ValueError(
            f"levels: hold {level.ravel()[np.abs(level).argmax()]}, beyond the half floats of "
            f"format '{texel_format.name}' (65504); 'rgba32f' is needed"
        )
    return values


def _with_channels(texels: np.ndarray, channels: int) -> np.ndarray:
    """The first channels; for four, gray becomes a color, and what lacks is 0, but alpha 1."""
    found = texels.shape[2]
    if found >= channels:
        return np.ascontiguousarray(texels[..., :channels])
    full = 255 if texels.dtype == np.uint8 else 1
    rgba = np.zeros((*texels.shape[:2], 4), texels.dtype)
    rgba[..., : 3 if found == 1 else found] = texels
    rgba[..., 3] = full
    return rgba


def _check_finite(who: str, image: np.ndarray) -> None:
    bad = np.argwhere(~np.isfinite(image))
    if len(bad):
        row, column, channel = bad[0]
        raise ValueError(
            f"{who}: the texel in row {row}, column {column} holds {image[row, column, channel]}; "
            f"finite values are needed"
        )
