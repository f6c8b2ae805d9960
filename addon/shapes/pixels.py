# SPDX-License-Identifier: GPL-3.0-or-later

"""Conversion of rasterized pixels to image data-blocks."""

import numpy as np
from prefilter.workflows.files import png
from prefilter.workflows.shapes.pixels import Pixels

from ..bridge.drawn_images import Drawing
from .choices import RasterizeSettings


def drawing(pixels: Pixels, settings: RasterizeSettings) -> Drawing:
    """Returns the contents of an image data-block."""
    height, width, _ = pixels.values.shape
    is_byte = settings.pixel_type == "byte"
    # Blender stores bytes with straight alpha and floats with associated alpha, and does not
    # convert packed images that conform.
    alpha_mode = "STRAIGHT" if is_byte else "PREMUL"
    if pixels.channels == 4 and pixels.is_straight != is_byte:
        alpha_mode = "CHANNEL_PACKED"
    values = None
    if not is_byte:
        values = pixels.floats()
        if pixels.channels < 4:
            opaque = np.ones((height, width, 4), np.float32)
            opaque[..., :3] = values
            values = opaque
    return Drawing(
        width,
        height,
        png.encoded(pixels.encoded(np.uint8)) if is_byte else None,
        values,
        settings.pixel_type == "half",
        pixels.is_mask,
        alpha_mode,
    )
