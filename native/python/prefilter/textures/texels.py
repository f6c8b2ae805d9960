# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of levels, and their conversion to a texel format."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_one_of
from .._border.arrays import as_image, as_texels
from ..images.color import to_linear
from .texel_formats import TEXEL_FORMATS, TexelFormat


def halving_levels(levels: Sequence[npt.ArrayLike], srgb: bool) -> list[np.ndarray]:
    """Returns levels, each uint8 or float32; raises ValueError unless each halves the previous one.

    uint16 becomes float32, decoded from sRGB if `srgb` is set.
    """
    if not isinstance(levels, Sequence) or isinstance(levels, str | bytes) or not levels:
        description = "an empty list" if isinstance(levels, list) else f"a {type(levels).__name__}"
        raise ValueError(f"levels: {description}; a list of images, level 0 first, is needed")
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
            half = max(1, before[0] // 2), max(1, before[1] // 2)
            if (height, width) != half:
                raise ValueError(
                    f"{who} has {width} x {height} texels; half of the one before, rounded down, "
                    f"is {half[1]} x {half[0]}"
                )
            if channels != before[2]:
                raise ValueError(
                    f"{who} has {channels} channels, the one before {before[2]}; they must be alike"
                )
        images.append(image)
    return images


def as_levels(levels: Sequence[npt.ArrayLike], srgb: bool) -> list[np.ndarray]:
    """Returns levels as `halving_levels` does, all uint8 or all float32 and finite."""
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
    """Returns the format with a name; for "auto", one that preserves all of a level."""
    if name == "auto":
        if level.dtype != np.uint8:
            return TEXEL_FORMATS["rgba16f"]
        name = {1: "r8", 2: "rg8"}.get(level.shape[2], "rgba8")
        return TEXEL_FORMATS["rgba8" if needs_srgb else name]
    as_one_of("format", name, ("auto", *TEXEL_FORMATS))
    texel_format = TEXEL_FORMATS[name]
    if texel_format.channels == 2 and level.shape[2] < 2:
        raise ValueError(f"format: '{name}' needs 2 channels; the levels have {level.shape[2]}")
    return texel_format


def encoded(
    level: np.ndarray,
    texel_format: TexelFormat,
    srgb: bool,
    *,
    weigh_by_alpha: bool,
    effort: str,
    progress: ProgressCallback | None,
    threads: int,
) -> bytes:
    """Returns a level as bytes for a file, the top row first."""
    if texel_format.is_float:
        flipped = np.ascontiguousarray(level[::-1])
        texels = _linear_floats(flipped, srgb, texel_format, threads)
    else:
        texels = _as_bytes(level, srgb, threads)
    if texel_format.is_block:
        rgba = _with_channels(texels, 4)
        if texel_format.is_float:
            rgba = rgba.view(np.uint16)
        return _native.compress_blocks(
            rgba, texel_format.name, srgb, weigh_by_alpha, effort, progress, threads
        )
    return _with_channels(texels, texel_format.channels).tobytes()


def rgba_bytes(level: np.ndarray, srgb: bool, threads: int) -> np.ndarray:
    """Returns a level as four channels of bytes, the top row first."""
    return _with_channels(_as_bytes(level, srgb, threads), 4)


def _as_bytes(level: np.ndarray, srgb: bool, threads: int) -> np.ndarray:
    flipped = np.ascontiguousarray(level[::-1])
    if flipped.dtype == np.uint8:
        return flipped
    return _native.to_bytes(flipped, srgb, threads)


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
    """Returns a number of channels: gray is repeated, missing colors are 0, missing alpha is 1."""
    present = texels.shape[2]
    if present >= channels:
        return np.ascontiguousarray(texels[..., :channels])
    full = 255 if texels.dtype == np.uint8 else 1
    rgba = np.zeros((*texels.shape[:2], 4), texels.dtype)
    rgba[..., : 3 if present == 1 else present] = texels
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
