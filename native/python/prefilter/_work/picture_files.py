# SPDX-License-Identifier: GPL-3.0-or-later

"""Picture files as pictures, with the values that Blender has of them."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import prefilter

from . import openimageio
from .alpha import associated, unassociated
from .picture import Encoding, FloatArray, Picture, without_fourth

_LINEAR, _DATA, _SRGB = "Linear Rec.709", "Non-Color", "sRGB"
_SHORT = np.float32(65535)


def read(argument: str, path: str, *, is_data: bool) -> Picture:
    """Reads a picture file.

    Bytes stay bytes, sRGB-encoded and with straight alpha. Of more bits than 8 become floats as
    light, with associated alpha, as floats are.

    Args:
        argument: What the path is called in messages.
        path: The file.
        is_data: Whether its values are no colors: they are then taken as they are.

    Raises:
        ValueError: Its channels are no image's.
        OSError: It cannot be read.
    """
    try:
        if not Path(path).is_file():
            raise OSError(f"there is no file '{path}'")
        values, is_straight = openimageio.read_pixels(Path(path))
    except (ValueError, OSError) as error:
        raise type(error)(f"{argument}: {error}") from error
    values = np.ascontiguousarray(_with_colors(values)[::-1])
    is_float = values.dtype != np.uint8
    is_integer = values.dtype != np.float32
    if values.dtype == np.uint8:
        texels: NDArray[Any] = values if is_straight else _straight_bytes(values)
    else:
        texels = _light(values, is_straight=is_straight, is_data=is_data)
    space = _DATA if is_data else _SRGB if is_integer else _LINEAR
    return Picture(
        name=Path(path).name,
        full_name=str(Path(path).resolve()),
        texels=_without_full_alpha(texels),
        is_float=is_float,
        is_integer=is_integer,
        encoding=Encoding.NONE if is_float or is_data else Encoding.SRGB,
        colorspace=space,
        is_data=is_data,
        alpha_mode="STRAIGHT" if is_integer else "PREMUL",
        linear_space=_LINEAR,
        ocio_config="",
    )


def _with_colors(values: NDArray[Any]) -> NDArray[Any]:
    """Returns three channels, or four with alpha; gray is given to all colors."""
    if values.shape[2] > 2:
        return values
    return values[..., [0, 0, 0, 1][: values.shape[2] + 2]]


def _straight_bytes(values: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Returns bytes whose colors are divided by alpha."""
    if values.shape[2] < 4:
        return values
    straight = unassociated(values.astype(np.float32) / np.float32(255))
    rounded: NDArray[np.uint8] = np.rint(straight.clip(0, 1) * 255).astype(np.uint8)
    return rounded


def _light(values: NDArray[Any], *, is_straight: bool, is_data: bool) -> FloatArray:
    """Returns floats as light, or as they are stored where they are data."""
    if values.dtype == np.float32:
        return values
    floats: FloatArray = values.astype(np.float32) / _SHORT
    has_alpha = values.shape[2] == 4
    if is_data:
        return floats
    if has_alpha and not is_straight:
        floats = unassociated(floats)
    floats = prefilter.to_linear(floats)
    return associated(floats) if has_alpha else floats


def _without_full_alpha(texels: NDArray[Any]) -> NDArray[Any]:
    full = 255 if texels.dtype == np.uint8 else 1
    if texels.shape[2] < 4 or not np.all(texels[..., 3] == full):
        return texels
    height, width = texels.shape[:2]
    return without_fourth(texels.reshape(-1)).reshape(height, width, 3)
