# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures as arrays, and their conversion from and to scene-linear light."""

from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

import prefilter

from . import openimageio
from .color_spaces import Space, named
from .openimageio import Check

FloatArray = NDArray[np.float32]
Texels = NDArray[Any]
"""Floats or bytes."""

_INDEPENDENT = frozenset({"CHANNEL_PACKED", "NONE"})
_VALUES_A_BAND = 1 << 20
LINEAR_REC709_NAMES = frozenset({"Linear", "Linear Rec.709"})
"""Names of scene-linear spaces with the primaries of Rec. 709."""


class Encoding(Enum):
    """How stored color relates to scene-linear color."""

    NONE = "none"
    SRGB = "srgb"
    OCIO = "ocio"
    SPACE = "space"


@dataclass(frozen=True)
class Picture:
    """The pixels of an image, with the information needed to interpret their colors.

    Attributes:
        name: The image's name.
        full_name: The name, and the file that Blender's datablock is linked from.
        texels: (height, width, 3 or 4) values as Blender stores them, floats or bytes, row 0 at the
            bottom. An alpha of 1 everywhere is omitted.
        is_float: Whether they are floats instead of bytes.
        is_integer: Whether the values come from integers, of any number of bits.
        encoding: How `texels` relate to scene-linear values.
        colorspace: The name of its color space.
        is_data: Whether the color space says that the values are not colors.
        alpha_mode: Meaning of alpha, in Blender's terms: STRAIGHT, PREMUL, CHANNEL_PACKED or NONE.
        linear_space: The name of the scene-linear space.
        ocio_config: Path of the OpenColorIO configuration.
        covers: Whether alpha is coverage, whatever the alpha mode.
        is_gray: Whether the file has one channel for all colors.
        space: The color space that `Encoding.SPACE` encodes, which also defines the primaries; None
            for `linear_space`.
        outside: The share of texels whose colors are outside of sRGB's range, but inside that of
            their own color space.
        orientation: EXIF orientation that was not applied; 1 is upright.
        left_out: Unread contents of its file, in words; empty for none.
    """

    name: str
    full_name: str
    texels: Texels
    is_float: bool
    is_integer: bool
    encoding: Encoding
    colorspace: str
    is_data: bool
    alpha_mode: str
    linear_space: str
    ocio_config: str
    covers: bool = False
    is_gray: bool = False
    space: Space | None = None
    outside: float = 0.0
    orientation: int = 1
    left_out: str = ""

    @property
    def reading_warnings(self) -> list[str]:
        """Warnings about unread contents of its file."""
        return [f"'{self.name}' also has {self.left_out}: not read"] if self.left_out else []

    @property
    def shape(self) -> tuple[int, int, int]:
        """Height, width and number of channels."""
        height, width, channels = self.texels.shape
        return height, width, channels

    @property
    def stored(self) -> FloatArray:
        """The texels as floats, as Blender returns them; converted if stored as bytes."""
        if self.texels.dtype == np.uint8:
            return _looked_up(self.texels, _BYTE_VALUES, _BYTE_VALUES)
        return self.texels

    @property
    def alpha_is_coverage(self) -> bool:
        """Whether there is an alpha channel that holds coverage."""
        known = self.covers or self.alpha_mode not in _INDEPENDENT
        return self.shape[2] == 4 and known and not self.is_data

    @property
    def alpha_is_associated(self) -> bool:
        """Whether colors are multiplied by an alpha that is coverage."""
        return self.alpha_is_coverage and not self.alpha_is_straight

    @property
    def alpha_is_straight(self) -> bool:
        """Whether colors must be multiplied by alpha before they are filtered."""
        return self.alpha_is_coverage and (not self.is_float or self.alpha_mode in _INDEPENDENT)


# Blender converts bytes to floats like this.
_BYTE_VALUES = np.arange(256, dtype=np.float32) * np.float32(1 / 255)
_DECODED_BYTES = prefilter.to_linear(_BYTE_VALUES[:, None, None])[:, 0, 0]


# A large image may leave no memory for a second one of floats: bands are copied into memory that
# has already been read.


def without_fourth(texels: Texels) -> Texels:
    """Removes the fourth channel of flat texels in place, and returns the shortened array."""
    count = len(texels) // 4
    for start in range(0, count, _VALUES_A_BAND):
        end = min(start + _VALUES_A_BAND, count)
        band = texels[4 * start : 4 * end].reshape(-1, 4)[:, :3].ravel()
        texels[3 * start : 3 * end] = band
    return texels[: 3 * count]


def _looked_up(
    texels: NDArray[np.uint8], colors: FloatArray, alphas: FloatArray, check: Check = lambda: None
) -> FloatArray:
    """Converts bytes by one lookup table for colors and one for alpha."""
    values = np.empty(texels.shape, np.float32)
    rows = max(1, _VALUES_A_BAND // (texels.shape[1] * texels.shape[2]))
    for start in range(0, len(texels), rows):
        check()
        band = slice(start, start + rows)
        values[band] = colors[texels[band]]
        if texels.shape[2] == 4:
            values[band, :, 3] = alphas[texels[band, :, 3]]
    return values


def with_coverage(picture: Picture) -> Picture:
    """Adds an alpha of 1, unless the picture has alpha or its channels are independent."""
    height, width, channels = picture.shape
    if channels == 4 or picture.is_data or picture.alpha_mode in _INDEPENDENT:
        return picture
    full = 255 if picture.texels.dtype == np.uint8 else 1
    texels = np.full((height, width, 4), full, picture.texels.dtype)
    texels[..., :3] = picture.texels
    return replace(picture, texels=texels)


def scene_linear(picture: Picture, check: Check = lambda: None) -> FloatArray:
    """Returns the picture's values as light; alpha is unchanged.

    Raises:
        ValueError: The color space cannot be decoded.
        OSError: OpenImageIO's Python module is needed and missing.
    """
    texels = picture.texels
    if texels.dtype == np.uint8 and picture.encoding is Encoding.SRGB:
        return _looked_up(texels, _DECODED_BYTES, _BYTE_VALUES, check)
    return _convert(picture, picture.stored, check, decode=True)


def light_or_bytes(picture: Picture, check: Check = lambda: None) -> tuple[Texels, str]:
    """Returns texels for `prefilter`'s filters, and their `encoding`: bytes where possible.

    Raises:
        ValueError: As `scene_linear`.
        OSError: As `scene_linear`.
    """
    if picture.texels.dtype == np.uint8 and picture.encoding in {Encoding.NONE, Encoding.SRGB}:
        return picture.texels, "srgb" if picture.encoding is Encoding.SRGB else "linear"
    return scene_linear(picture, check), "linear"


def encoded(picture: Picture, linear: FloatArray, check: Check = lambda: None) -> FloatArray:
    """Returns scene-linear values as `picture` stores them: the inverse of `scene_linear`.

    Raises:
        ValueError: The color space cannot be encoded.
        OSError: OpenImageIO's Python module is needed and missing.
    """
    return _convert(picture, linear, check, decode=False)


def as_srgb(picture: Picture) -> Picture:
    """Returns the picture with its values interpreted as sRGB-encoded colors."""
    if picture.linear_space in LINEAR_REC709_NAMES:
        return replace(picture, encoding=Encoding.SRGB)
    return replace(picture, encoding=Encoding.OCIO, colorspace="sRGB")


def in_rec709(picture: Picture, light: FloatArray, check: Check = lambda: None) -> FloatArray:
    """Converts scene-linear values to the primaries of Rec. 709.

    Raises:
        ValueError: As `scene_linear`.
        OSError: As `scene_linear`.
    """
    if picture.is_data or picture.linear_space in LINEAR_REC709_NAMES:
        return light
    space = named(picture.linear_space)
    if space is None or not space.is_linear:
        return prefilter.to_linear(encoded(as_srgb(picture), light, check))
    converted = light.copy()
    converted[..., :3] = space.in_rec709(np.ascontiguousarray(light[..., :3]))
    return converted


def automatic_bounds(
    linear: FloatArray, *, is_associated: bool = False
) -> tuple[float, float | None]:
    """Returns the value range of levels: 0 to 1, extended to the image's own range.

    Associated colors get no upper limit, because a solver's limit would change their ratio to
    alpha; `capped` limits them afterwards.
    """
    low = linear.min(where=np.isfinite(linear), initial=0.0)
    return float(low), None if is_associated else _highest(linear)


def capped(level: FloatArray, linear: FloatArray) -> FloatArray:
    """Limits alpha and colors of an associated level to the image's highest values."""
    divisor = np.maximum(level[..., 3:] / np.float32(_highest(linear[..., 3:])), 1)
    limited: FloatArray = level / divisor
    np.minimum(limited[..., :3], _highest(linear[..., :3]), out=limited[..., :3])
    return limited


def _highest(linear: FloatArray) -> float:
    return float(linear.max(where=np.isfinite(linear), initial=1.0))


def _convert(picture: Picture, pixels: FloatArray, check: Check, *, decode: bool) -> FloatArray:
    if picture.encoding is Encoding.NONE:
        return pixels
    if picture.encoding is Encoding.SRGB:
        return prefilter.to_linear(pixels) if decode else prefilter.to_srgb(pixels)
    if picture.encoding is Encoding.SPACE:
        assert picture.space is not None
        made = pixels.copy()
        change = picture.space.decoded if decode else picture.space.encoded
        made[..., :3] = change(np.ascontiguousarray(pixels[..., :3]))
        return made
    spaces = (picture.colorspace, picture.linear_space)
    source, target = spaces if decode else reversed(spaces)
    colors = np.ascontiguousarray(pixels[..., :3])
    try:
        converted = openimageio.color_convert(colors, source, target, picture.ocio_config, check)
    except ValueError as error:
        raise ValueError(
            f"image '{picture.name}': cannot convert its color space '{picture.colorspace}': "
            f"{error}"
        ) from error
    result = pixels.copy()
    result[..., :3] = converted
    return result
