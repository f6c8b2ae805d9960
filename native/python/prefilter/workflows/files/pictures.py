# SPDX-License-Identifier: GPL-3.0-or-later

"""Writing single pictures as PNG and OpenEXR files."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...files import staging
from ...textures.exr import write_exr_picture
from .. import space_names
from . import png

ENDINGS = (".png", ".exr")


def stage(
    target: Path,
    pixels: NDArray[Any],
    *,
    is_data: bool,
    is_half: bool,
    linear_space: str = space_names.REC709_LINEAR,
    has_alpha: bool = True,
    chunks: Sequence[tuple[bytes, bytes]] = (),
    metadata: Mapping[str, str] | None = None,
) -> staging.StagedFile:
    """Stages a picture file.

    Args:
        target: A path that ends in one of `ENDINGS`.
        pixels: (h, w, 1 to 4) array, row 0 at the bottom. For PNG: uint8 or uint16, sRGB-encoded
            unless it is data, with straight alpha. For OpenEXR: float32, scene-linear, with
            associated alpha. The values are written unchanged.
        is_data: Whether the values are not colors; OpenEXR files declare that.
        is_half: Whether OpenEXR gets 16-bit floats instead of 32-bit ones.
        linear_space: The name of the color space for OpenEXR.
        has_alpha: Whether the last one of two or four channels is alpha.
        chunks: Color chunks of a PNG file, instead of sRGB.
        metadata: Key-value pairs to store in the file.

    Raises:
        OSError: The file cannot be written.
    """
    if target.suffix.lower() == ".png":
        is_srgb = not is_data and not chunks
        data = png.encoded(pixels, is_srgb=is_srgb, texts=metadata, chunks=chunks)
        return staging.stage_data(target, data)
    write = partial(
        write_exr_picture,
        pixels=np.asarray(pixels, np.float32),
        format="half" if is_half else "float",
        alpha="premultiplied" if has_alpha and not is_data else "independent",
        attributes={
            **exr_attributes(space_names.DATA if is_data else linear_space),
            **(metadata or {}),
        },
        chromaticities=None if is_data else space_names.chromaticities_of(linear_space),
    )
    return staging.stage_bytes(target, write)


def exr_attributes(space: str) -> dict[str, str]:
    """Returns the attributes of an OpenEXR header for a color space, except chromaticities."""
    name = space_names.interop_name(space)
    known = {"colorInteropID": name} if name else {}
    return {"Software": "Prefilter", "oiio:ColorSpace": name or space, **known}


def in_file_channels(pixels: NDArray[Any], *, is_gray: bool) -> NDArray[Any]:
    """Returns pixels with one channel for all colors, if the file is gray and they are equal."""
    if not is_gray or pixels.shape[2] < 3:
        return pixels
    gray = pixels[..., :1]
    if not all(np.array_equal(gray[..., 0], pixels[..., other]) for other in (1, 2)):
        return pixels
    return np.ascontiguousarray(pixels[..., [0, 3][: pixels.shape[2] - 2]])
