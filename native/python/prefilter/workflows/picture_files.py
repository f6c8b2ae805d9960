# SPDX-License-Identifier: GPL-3.0-or-later

"""Reading picture files, with the same values as Blender has of them."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import prefilter

from . import color_spaces, openimageio
from .alpha import associated, unassociated
from .color_spaces import Space
from .damage import damaged
from .files.embedded import read_embedded
from .picture import Encoding, FloatArray, Picture, without_fourth
from .picture_colors import orientation_of, space_of, upright
from .space_names import AUTO

_LINEAR, _DATA, _SRGB = "Linear Rec.709", "Non-Color", "sRGB"
_UNSEEN = np.float32(1 / 2048)
"""Tolerance for colors slightly beyond a range, which are clipped to it."""


def read(
    argument: str,
    path: str,
    *,
    is_data: bool,
    colorspace: str = AUTO,
    keeps_chunks: bool = False,
    keeps_bytes: bool = False,
    turns: bool = True,
) -> Picture:
    """Reads a picture file.

    sRGB bytes stay bytes, with straight alpha. Deeper integers become floats of light with
    associated alpha, like floats. Colors of other spaces become linear Rec. 709.

    Args:
        argument: The path's name in messages.
        path: The file.
        is_data: Whether its values are not colors, and stay as they are.
        colorspace: The color space to assume; `AUTO` for the one that the file declares.
        keeps_chunks: Whether the result becomes a PNG file, which can declare the same space.
        keeps_bytes: Whether bytes of other spaces become sRGB bytes.
        turns: Whether to apply the EXIF orientation.

    Raises:
        ValueError: Its channels do not form an image, or its color space cannot be converted.
        MemoryError: It is too large for the free memory.
        OSError: It cannot be read.
    """
    try:
        if not Path(path).is_file():
            raise OSError(f"there is no file '{path}'")
        values, is_straight, metadata, left_out = openimageio.read_pixels(Path(path))
        embedded = read_embedded(Path(path))
    except UnicodeError as error:
        reason = damaged(path, str(error))
        raise OSError(f"{argument}: '{path}' cannot be read as a picture: {reason}") from error
    except (ValueError, OSError, MemoryError) as error:
        raise type(error)(f"{argument}: {error}") from error
    try:
        space = space_of(
            metadata,
            embedded,
            is_integer=values.dtype != np.float32,
            is_gray=values.shape[2] < 3,
            colorspace=colorspace,
        )
    except ValueError as error:
        if not is_data or metadata.model:
            raise ValueError(f"{argument}: '{path}': {error}") from error
        space = None
    orientation = orientation_of(metadata, embedded)
    values = upright(values, orientation) if turns else values
    picture = _read_in(
        None if is_data else space,
        np.ascontiguousarray(_with_colors(values)[::-1]),
        is_straight=is_straight,
        is_gray=values.shape[2] < 3,
        keeps_chunks=keeps_chunks,
        keeps_bytes=keeps_bytes,
    )
    return replace(
        picture,
        name=Path(path).name,
        full_name=str(Path(path).resolve()),
        texels=_without_full_alpha(picture.texels),
        orientation=1 if turns else orientation,
        left_out=left_out,
    )


@dataclass(frozen=True)
class Probe:
    """Metadata of a picture file, known before its pixels are read.

    Attributes:
        is_plain: Whether it is upright and its colors are in the format's default space.
        is_gray: Whether it has one channel for all colors.
    """

    is_plain: bool
    is_gray: bool


def probe(argument: str, path: str, *, is_data: bool) -> Probe | None:
    """Returns metadata of a picture file; None if OpenImageIO is missing or cannot read it.

    Raises:
        MemoryError: It is too large for the free memory.
    """
    try:
        metadata, channels, is_float = openimageio.read_metadata(Path(path))
    except OSError:
        return None
    except MemoryError as error:
        raise MemoryError(f"{argument}: {error}") from error
    embedded, is_gray = read_embedded(Path(path)), channels in {1, 2}
    is_usual = not metadata.model
    if is_usual and not is_data:
        try:
            space = space_of(metadata, embedded, is_integer=not is_float, is_gray=is_gray)
        except ValueError:
            is_usual = False
        else:
            usual = color_spaces.LINEAR if is_float else color_spaces.SRGB
            is_usual = space is not None and space.agrees(usual)
    return Probe(is_usual and orientation_of(metadata, embedded) == 1, is_gray)


def _read_in(
    space: Space | None,
    values: NDArray[Any],
    *,
    is_straight: bool,
    is_gray: bool,
    keeps_chunks: bool,
    keeps_bytes: bool,
) -> Picture:
    """Returns an unnamed picture of values in a color space; None for data."""
    is_byte, is_integer = values.dtype == np.uint8, values.dtype != np.float32
    picture = Picture(
        name="",
        full_name="",
        texels=values,
        is_float=not is_byte,
        is_integer=is_integer,
        encoding=Encoding.NONE if not is_byte or space is None else Encoding.SRGB,
        colorspace=_DATA if space is None else _SRGB if is_integer else _LINEAR,
        is_data=space is None,
        alpha_mode="STRAIGHT" if is_integer else "PREMUL",
        linear_space=_LINEAR,
        ocio_config="",
        is_gray=is_gray,
    )
    if is_byte and (space is None or space is color_spaces.SRGB):
        return replace(picture, texels=values if is_straight else _straight_bytes(values))
    if space is None:
        return replace(picture, texels=_as_floats(values))
    if keeps_chunks and space.can_be_kept(is_gray=is_gray):
        if is_byte:
            texels = values if is_straight else _straight_bytes(values)
            return replace(picture, texels=texels, encoding=Encoding.SPACE, space=space)
        return replace(picture, texels=_light(values, space, is_straight), space=space)
    # Bytes preserve colors where straight alpha is 0; linear light would lose them.
    stays_straight = is_byte and keeps_bytes
    light = _light(values, space, is_straight, is_associated=not stays_straight)
    if not space.is_rec709:
        colors = space.in_rec709(np.ascontiguousarray(light[..., :3]))
        outside = _share_outside(light, colors, is_associated=not stays_straight)
        light[..., :3] = colors
        picture = replace(picture, outside=outside)
    if stays_straight:
        return replace(picture, texels=color_spaces.srgb_bytes(light))
    return replace(picture, texels=light, is_float=True, encoding=Encoding.NONE)


def _share_outside(light: FloatArray, converted: FloatArray, *, is_associated: bool) -> float:
    """Returns the share of visible texels that leave the range [0, 1] by the conversion.

    Args:
        light: Colors of one space, and alpha.
        converted: The same colors in another.
        is_associated: Whether colors are multiplied by alpha.
    """
    most: Any = np.float32(1)
    if light.shape[2] == 4:
        most = light[..., 3:] if is_associated else np.ceil(light[..., 3:])
    within = np.all((light[..., :3] >= 0) & (light[..., :3] <= most), axis=2)
    slack = most * _UNSEEN
    beyond = np.any((converted < -slack) | (converted > most + slack), axis=2)
    return float(np.mean(within & beyond))


def _with_colors(values: NDArray[Any]) -> NDArray[Any]:
    """Returns three channels, or four with alpha; gray is repeated."""
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


def _as_floats(values: NDArray[Any]) -> FloatArray:
    if values.dtype == np.float32:
        return values
    floats: FloatArray = values.astype(np.float32) / np.float32(np.iinfo(values.dtype).max)
    return floats


def _light(
    values: NDArray[Any], space: Space, is_straight: bool, *, is_associated: bool = True
) -> FloatArray:
    """Converts values of a color space to light, with associated or straight alpha."""
    floats = _as_floats(values)
    has_alpha = floats.shape[2] == 4
    if space.is_linear and has_alpha and is_straight != is_associated:
        return floats
    if has_alpha and not is_straight:
        floats = unassociated(floats)
    if space is color_spaces.SRGB:
        floats = prefilter.to_linear(floats)
    elif not space.is_linear:
        floats = floats.copy()
        floats[..., :3] = space.decoded(np.ascontiguousarray(floats[..., :3]))
    return associated(floats) if has_alpha and is_associated else floats


def _without_full_alpha(texels: NDArray[Any]) -> NDArray[Any]:
    full = 255 if texels.dtype == np.uint8 else 1
    if texels.shape[2] < 4 or not np.all(texels[..., 3] == full):
        return texels
    height, width = texels.shape[:2]
    return without_fourth(texels.reshape(-1)).reshape(height, width, 3)
