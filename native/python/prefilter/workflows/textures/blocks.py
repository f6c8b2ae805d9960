# SPDX-License-Identifier: GPL-3.0-or-later

"""Choosing compressed texel formats that suit an image's content."""

from collections.abc import Iterable

import numpy as np

import prefilter

from ..picture import Encoding, Picture


def suitable_format(
    picture: Picture,
    content: str,
    *,
    reads_alpha: bool = False,
    is_height: bool = False,
    is_one_channel: bool = False,
) -> str:
    """Returns the key of the smallest texel format that preserves an image.

    Args:
        picture: Its pixels.
        content: A key of `choices.CONTENTS`, except "auto".
        reads_alpha: Whether shaders read its alpha; implied if alpha is coverage.
        is_height: Whether it holds heights, which need more than 8 bits.
        is_one_channel: Whether shaders read only its red channel.
    """
    reads_alpha = reads_alpha or picture.alpha_is_coverage
    if content == "normal":
        return _smallest(4 if reads_alpha else 2)
    if picture.is_float and (not picture.is_integer or is_height):
        is_signed = not _is_positive(picture)
        return _smallest(4 if reads_alpha else 3, is_float=True, is_signed=is_signed)
    has_no_srgb = picture.is_float or picture.encoding is Encoding.NONE
    is_data = has_no_srgb and content != "color" and not reads_alpha
    if is_data and (is_one_channel or is_gray(picture)):
        return _smallest(1)
    return _smallest(4 if reads_alpha else 3)


def common_format(keys: Iterable[str]) -> str:
    """Returns the one of several formats that suits all images that the others suit."""

    def extent(key: str) -> tuple[bool, float, int]:
        texel_format = prefilter.TEXEL_FORMATS[key]
        return texel_format.is_float, texel_format.texel_bytes, texel_format.channels

    return max(keys, key=extent)


def _smallest(channels: int, *, is_float: bool = False, is_signed: bool = False) -> str:
    """Returns the key of the smallest DDS format that preserves this many channels well."""
    fitting = (
        texel_format
        for texel_format in prefilter.TEXEL_FORMATS.values()
        if texel_format.is_in_dds
        and texel_format.channels >= channels
        and texel_format.is_float == is_float
        and (texel_format.keeps_negatives or not is_signed)
        and (texel_format.alpha == "full" or channels < 4)
        and not texel_format.is_coarse
    )
    return min(
        fitting, key=lambda texel_format: (texel_format.texel_bytes, texel_format.channels)
    ).name


def is_gray(picture: Picture) -> bool:
    """Tells whether red, green and blue are equal everywhere."""
    return bool((picture.texels[..., :1] == picture.texels[..., 1:3]).all())


def _is_positive(picture: Picture) -> bool:
    return bool(np.nanmin(picture.texels[..., :3]) >= 0.0)
