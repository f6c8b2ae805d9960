# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures of one level, as PNG and OpenEXR files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..._border import staging
from .. import openimageio
from . import png

ENDINGS = (".png", ".exr")


def stage(
    target: Path,
    pixels: NDArray[Any],
    *,
    is_data: bool,
    is_half: bool,
    metadata: Mapping[str, str] | None = None,
) -> staging.StagedFile:
    """Writes a picture beside its target.

    Args:
        target: A path that ends in one of `ENDINGS`.
        pixels: (h, w, 1, 3 or 4) array, row 0 at the bottom. For PNG it is of uint8 or uint16, and
            sRGB-encoded unless it is data; for OpenEXR of float32 and scene-linear. It is written
            as it is: PNG files should have straight alpha, and OpenEXR files associated alpha.
        is_data: Whether the values are no colors; OpenEXR files say so.
        is_half: Whether OpenEXR gets 16-bit floats instead of 32-bit ones.
        metadata: What the file is to keep, by keys.

    Raises:
        OSError: The file cannot be written.
    """
    if target.suffix.lower() == ".png":
        return staging.stage_data(target, png.encoded(pixels, is_srgb=not is_data, texts=metadata))
    flipped = np.ascontiguousarray(pixels[::-1], np.float32)
    return staging.stage_with(
        target,
        lambda path: openimageio.write_picture(
            path,
            flipped,
            "raw" if is_data else "scene_linear",
            pixel_type="half" if is_half else "float",
            attributes=metadata,
        ),
    )
