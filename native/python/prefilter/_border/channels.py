# SPDX-License-Identifier: GPL-3.0-or-later

"""Filtering of images with many channels by native functions that take up to four."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from .arguments import ProgressCallback, as_progress, progress_part
from .arrays import FloatArray, check_texels

_CHANNELS_AT_ONCE = 4

Found = TypeVar("Found")


def in_channel_groups(
    image: FloatArray,
    premultiplied: bool,
    filtered: Callable[[FloatArray, bool, ProgressCallback | None], Found],
    progress: ProgressCallback | None,
) -> list[Found]:
    """Returns the results of `filtered` for each group of up to four channels.

    Its arguments are the channels, whether to filter them as they stand, and a progress callback.
    Images of more than four channels have no alpha.
    """
    channels = image.shape[2]
    if channels <= _CHANNELS_AT_ONCE:
        return [filtered(image, premultiplied, as_progress(progress))]
    check_texels("image", image)  # Here, so that messages count the image's own channels.
    results = []
    for begin in range(0, channels, _CHANNELS_AT_ONCE):
        end = min(begin + _CHANNELS_AT_ONCE, channels)
        part = np.ascontiguousarray(image[..., begin:end])
        reports = progress_part(progress, begin / channels, end / channels)
        results.append(filtered(part, True, reports))
    return results
