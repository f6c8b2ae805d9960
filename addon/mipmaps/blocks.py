# SPDX-License-Identifier: GPL-3.0-or-later

"""Which compressed blocks suit what an image holds."""

import numpy as np

from ..bridge.images import Encoding, Picture


def suiting(
    picture: Picture,
    content: str,
    *,
    reads_alpha: bool = False,
    is_height: bool = False,
    is_one_channel: bool = False,
) -> str:
    """Returns the key of the texel format that suits an image.

    Args:
        picture: Its pixels.
        content: A key of `choices.CONTENTS`, and not "auto".
        reads_alpha: Whether shaders read its alpha; they do where it is coverage.
        is_height: Whether it holds heights, of which more than 8 bits are kept.
        is_one_channel: Whether shaders read its red channel alone.
    """
    reads_alpha = reads_alpha or picture.alpha_is_coverage
    if content == "normal":
        return "bc7" if reads_alpha else "bc5"
    if picture.is_float and (not picture.is_integer or is_height):
        return "rgba16f" if reads_alpha or not _is_positive(picture) else "bc6h"
    has_no_srgb = picture.is_float or picture.encoding is Encoding.NONE
    is_data = has_no_srgb and content != "color" and not reads_alpha
    if is_data and (is_one_channel or is_gray(picture)):
        return "bc4"
    return "bc7"


def is_gray(picture: Picture) -> bool:
    """Tells whether red, green and blue are the same everywhere."""
    return bool((picture.texels[..., :1] == picture.texels[..., 1:3]).all())


def _is_positive(picture: Picture) -> bool:
    return bool(np.nanmin(picture.texels[..., :3]) >= 0.0)
