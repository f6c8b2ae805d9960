# SPDX-License-Identifier: GPL-3.0-or-later

"""Image datablocks to scene-linear arrays, and what decoded colors are stored as.

What Blender keeps in `Image.pixels` (rows from the bottom, always four channels):

* a byte image: display values of the image's color space, with straight alpha. Even with the
  alpha mode Premultiplied: Blender divides by alpha on load;
* a float image: scene-linear values, with associated alpha. Blender converts on load.

Alpha is coverage unless the alpha mode is Channel Packed or None or the color space is data; then
the four channels are independent. But a material may use the alpha of a Channel Packed image as
coverage all the same, as those of Blender's glTF importer do: colors are straight then, of
floats too, as such an image is not converted on load.
"""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from ..core.wording import listed
from . import openimageio
from .openimageio import Check

FloatArray = NDArray[np.float32]
Texels = NDArray[Any]
"""Of floats or of bytes."""

_KIND_OF_SOURCE = {
    "TILED": "a UDIM (tiled) image",
    "MOVIE": "a movie",
    "SEQUENCE": "an image sequence",
    "VIEWER": "a viewer image",
}
_KIND_OF_TYPE = {
    "MULTILAYER": "a multi-layer image",
    "RENDER_RESULT": "a render result",
    "COMPOSITING": "a compositor result",
}
_INDEPENDENT = frozenset({"CHANNEL_PACKED", "NONE"})
_VALUES_A_BAND = 1 << 20
_LINEAR_REC709_NAMES = frozenset({"Linear", "Linear Rec.709"})


class Encoding(Enum):
    """How stored color relates to scene-linear color."""

    NONE = "none"
    SRGB = "srgb"
    OCIO = "ocio"


@dataclass(frozen=True)
class Picture:
    """The pixels of an image datablock, and what is needed to read them as light.

    Attributes:
        name: The datablock's name.
        full_name: The name, and the file that the datablock is linked from.
        texels: (height, width, 3 or 4) values as Blender keeps them, floats or bytes, row 0 at the
            bottom. An alpha that is 1 everywhere is left out.
        is_float: Whether the datablock holds floats instead of bytes.
        is_integer: Whether the values come from integers, of bytes or of a file of more bits.
        encoding: How `texels` relate to scene-linear values.
        colorspace: The name of the datablock's color space.
        is_data: Whether the color space says that the values are no colors.
        alpha_mode: The datablock's alpha mode.
        linear_space: The name of Blender's scene-linear space.
        ocio_config: Path of Blender's OpenColorIO configuration.
        covers: Whether alpha is known to be coverage, whatever the alpha mode.
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

    @property
    def shape(self) -> tuple[int, int, int]:
        """Height, width and number of channels."""
        height, width, channels = self.texels.shape
        return height, width, channels

    @property
    def stored(self) -> FloatArray:
        """The texels as floats, as Blender gives them out; made anew of bytes."""
        if self.texels.dtype == np.uint8:
            return _looked_up(self.texels, _BYTE_VALUES, _BYTE_VALUES)
        return self.texels

    @property
    def alpha_is_coverage(self) -> bool:
        """Whether there is an alpha channel that says how much of a texel is covered."""
        known = self.covers or self.alpha_mode not in _INDEPENDENT
        return self.shape[2] == 4 and known and not self.is_data

    @property
    def alpha_is_straight(self) -> bool:
        """Whether colors have to be multiplied by alpha before they are filtered."""
        return self.alpha_is_coverage and (not self.is_float or self.alpha_mode in _INDEPENDENT)


def find(name: str) -> bpy.types.Image:
    """Returns the image datablock of that name.

    Raises:
        ValueError: There is none.
    """
    image = bpy.data.images.get(name)
    if image is None:
        known = listed(other.name for other in bpy.data.images) or "no image"
        raise ValueError(f"image: found no image named '{name}'; this file has {known}")
    return image


def load(argument: str, path: str, *, is_data: bool) -> bpy.types.Image:
    """Loads a picture file; an image that the .blend file has of it stays as it is there.

    Args:
        argument: What the path is called in messages.
        path: The file.
        is_data: Whether its values are no colors.

    Raises:
        OSError: It cannot be loaded.
    """
    before = set(bpy.data.images)
    try:
        image = bpy.data.images.load(os.path.abspath(path), check_existing=True)
    except RuntimeError as error:
        raise OSError(f"{argument}: cannot load '{path}': {str(error).strip()}") from error
    if is_data and image not in before:
        image.colorspace_settings.is_data = True
    return image


def read(image: bpy.types.Image) -> Picture:
    """Copies an image datablock's pixels.

    Raises:
        ValueError: The datablock is no single still image, or it has no pixels.
    """
    kind = _KIND_OF_SOURCE.get(image.source) or _KIND_OF_TYPE.get(image.type)
    if kind is not None:
        raise ValueError(f"image '{image.name}': found {kind}; a single still image is needed")
    was_loaded = image.has_data
    width, height = image.size
    count = len(image.pixels)
    if width == 0 or height == 0 or count == 0:
        raise ValueError(f"image '{image.name}': {_why_empty(image)}")
    pixels = np.empty(count, np.float32)
    image.pixels.foreach_get(pixels)
    channels = count // (width * height)
    texels = pixels if image.is_float else _as_bytes(pixels)
    if channels == 4 and np.all(texels[3::4] == (1 if image.is_float else 255)):
        texels = _without_fourth(texels)
        channels = 3
    space = image.colorspace_settings
    linear_space = scene_linear_name()
    picture = Picture(
        name=image.name,
        full_name=image.name_full,
        texels=texels.reshape(height, width, channels),
        is_float=image.is_float,
        is_integer=not image.is_float or _has_integer_file(image),
        encoding=_encoding(image, linear_space),
        colorspace=space.name,
        is_data=space.is_data,
        alpha_mode=image.alpha_mode,
        linear_space=linear_space,
        ocio_config=_ocio_config(),
    )
    if not was_loaded and image.source == "FILE" and not image.is_dirty:
        # Blender read the file for this alone, and reads it again where it needs it.
        image.buffers_free()
    return picture


# Blender's own way from bytes to floats.
_BYTE_VALUES = np.arange(256, dtype=np.float32) * np.float32(1 / 255)
_DECODED_BYTES = prefilter.to_linear(_BYTE_VALUES[:, None, None])[:, 0, 0]


# A large image leaves no memory for a second one of floats: in both of these a band is copied, and
# written to memory that was read before.


def _as_bytes(pixels: FloatArray) -> NDArray[np.uint8]:
    """Returns what bytes were, of one axis, in the memory of the floats, which is cut down."""
    count = len(pixels)
    narrow = pixels.view(np.uint8)
    for start in range(0, count, _VALUES_A_BAND):
        band = pixels[start : start + _VALUES_A_BAND] * np.float32(255)
        narrow[start : start + len(band)] = np.rint(band, out=band)
    del narrow
    pixels.resize(-(-count // 4), refcheck=False)
    return pixels.view(np.uint8)[:count]


def _without_fourth(texels: Texels) -> Texels:
    """Returns texels of one axis without the fourth of their channels, in the same memory."""
    count = len(texels) // 4
    for start in range(0, count, _VALUES_A_BAND):
        end = min(start + _VALUES_A_BAND, count)
        band = texels[4 * start : 4 * end].reshape(-1, 4)[:, :3].ravel()
        texels[3 * start : 3 * end] = band
    return texels[: 3 * count]


def _looked_up(
    texels: NDArray[np.uint8], colors: FloatArray, alphas: FloatArray, check: Check = lambda: None
) -> FloatArray:
    """Returns the values that bytes stand for, by two tables."""
    values = np.empty(texels.shape, np.float32)
    rows = max(1, _VALUES_A_BAND // (texels.shape[1] * texels.shape[2]))
    for start in range(0, len(texels), rows):
        check()
        band = slice(start, start + rows)
        values[band] = colors[texels[band]]
        if texels.shape[2] == 4:
            values[band, :, 3] = alphas[texels[band, :, 3]]
    return values


def _has_integer_file(image: bpy.types.Image) -> bool:
    """Tells whether the pixels come from a file of integers, as 16-bit PNG; Blender has floats."""
    if image.source != "FILE":
        return False
    if image.packed_file is None:
        return openimageio.holds_integers(bpy.path.abspath(image.filepath, library=image.library))
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, "picture")
        with open(copy, "wb") as file:
            file.write(image.packed_file.data)
        return openimageio.holds_integers(copy)


def with_coverage(picture: Picture) -> Picture:
    """Returns the picture with an alpha of 1, unless it has one or its channels are independent."""
    height, width, channels = picture.shape
    if channels == 4 or picture.is_data or picture.alpha_mode in _INDEPENDENT:
        return picture
    full = 255 if picture.texels.dtype == np.uint8 else 1
    texels = np.full((height, width, 4), full, picture.texels.dtype)
    texels[..., :3] = picture.texels
    return replace(picture, texels=texels)


def check_untiled(image: bpy.types.Image) -> None:
    """Raises ValueError where the image has UDIM tiles."""
    if image.source == "TILED":
        raise ValueError(f"image '{image.name}': has UDIM tiles; an image without tiles is needed")


def tile_numbers(image: bpy.types.Image) -> list[int]:
    """Returns the numbers of a UDIM image's tiles; none for another image."""
    return [tile.number for tile in image.tiles] if image.source == "TILED" else []


def read_tile(image: bpy.types.Image, number: int) -> Picture:
    """Copies the pixels of a UDIM tile, from its file: Blender gives out those of one tile only.

    Raises:
        ValueError: The tile has no file, it cannot be read, or it differs from what Blender shows.
    """
    who = f"image '{image.name}', tile {number}"
    if image.is_dirty:
        raise ValueError(f"{who}: has changes that are not in its file; save the image first")
    with _tile_file(image, number, who) as path:
        try:
            tile = bpy.data.images.load(path)
        except RuntimeError as error:
            raise ValueError(f"{who}: cannot be read: {str(error).strip()}") from error
        try:
            tile.colorspace_settings.name = image.colorspace_settings.name
            tile.alpha_mode = image.alpha_mode
            picture = read(tile)
        finally:
            bpy.data.images.remove(tile)
    return replace(picture, name=f"{image.name}.{number}", full_name=f"{image.name_full}.{number}")


def files_of(image: bpy.types.Image) -> dict[int | None, Path]:
    """Returns the file that a still image is rendered from, or those of a UDIM image's tiles.

    Returns:
        Absolute paths, by the number of the tile; None stands for an image without tiles.

    Raises:
        ValueError: The image is rendered from something else, or a file is missing.
    """
    kind = kind_that_is_no_still(image)
    if kind is not None:
        raise ValueError(f"image '{image.name}': found {kind}; a picture file is needed")
    if image.packed_files:
        raise ValueError(
            f"image '{image.name}' is packed: unpack it, because Cycles caches only files"
        )
    if image.is_dirty:
        raise ValueError(f"image '{image.name}': has changes that are not in its file; save it")
    numbers = tile_numbers(image)
    paths: dict[int | None, Path] = {number: tile_path(image, number) for number in numbers}
    if not numbers:
        paths[None] = Path(bpy.path.abspath(image.filepath, library=image.library))
    for path in paths.values():
        if not path.is_file():
            raise ValueError(f"image '{image.name}': there is no file '{path}'")
    return paths


def kind_that_is_no_still(image: bpy.types.Image) -> str | None:
    """Returns what an image is that has no file of a still, packed or not; None for others."""
    kind = _KIND_OF_TYPE.get(image.type)
    if kind is None and image.source not in {"FILE", "TILED"}:
        kind = _KIND_OF_SOURCE.get(image.source, "a generated image, which has no file")
    return kind


def kind_that_is_not_read(image: bpy.types.Image) -> str | None:
    """Returns what an image is whose pixels, or those of its tiles, are not read; else None."""
    if image.source == "TILED":
        return None
    return _KIND_OF_SOURCE.get(image.source) or _KIND_OF_TYPE.get(image.type)


@contextmanager
def _tile_file(image: bpy.types.Image, number: int, who: str) -> Iterator[str]:
    """Yields the path of a tile's file, for the time being where the tile is packed."""
    path = str(tile_path(image, number))
    packed = next((file for file in image.packed_files if file.tile_number == number), None)
    if packed is not None:
        with tempfile.TemporaryDirectory() as folder:
            copy = os.path.join(folder, os.path.basename(path))
            with open(copy, "wb") as file:
                file.write(packed.packed_file.data)
            yield copy
        return
    if not os.path.isfile(path):
        raise ValueError(f"{who}: there is no file '{path}'; save the image first")
    yield path


def tile_path(image: bpy.types.Image, number: int) -> Path:
    """Returns the absolute path of the file of a UDIM tile."""
    column, row = (number - 1001) % 10, (number - 1001) // 10
    path = image.filepath.replace("<UDIM>", str(number))
    path = path.replace("<UVTILE>", f"u{column + 1}_v{row + 1}")
    return Path(bpy.path.abspath(path, library=image.library))


def scene_linear(picture: Picture, check: Check = lambda: None) -> FloatArray:
    """Returns the picture's values as light, with alpha as it is stored.

    Args:
        picture: The picture.
        check: Called between the parts of a conversion that takes long.

    Raises:
        ValueError: The color space cannot be decoded.
        OSError: It needs OpenImageIO's Python module, which is missing.
    """
    texels = picture.texels
    if texels.dtype == np.uint8 and picture.encoding is Encoding.SRGB:
        return _looked_up(texels, _DECODED_BYTES, _BYTE_VALUES, check)
    return _convert(picture, picture.stored, check, decode=True)


def light_or_bytes(picture: Picture, check: Check = lambda: None) -> tuple[Texels, str]:
    """Returns what `prefilter` takes for the picture, and its `encoding`: bytes where it can.

    Args:
        picture: The picture.
        check: As for `scene_linear`.

    Raises:
        ValueError: As `scene_linear`.
        OSError: As `scene_linear`.
    """
    if picture.texels.dtype == np.uint8 and picture.encoding is not Encoding.OCIO:
        return picture.texels, "srgb" if picture.encoding is Encoding.SRGB else "linear"
    return scene_linear(picture, check), "linear"


def encoded(picture: Picture, linear: FloatArray, check: Check = lambda: None) -> FloatArray:
    """Returns scene-linear values as `picture` stores them: the inverse of `scene_linear`.

    Args:
        picture: What says how.
        linear: The values.
        check: Called between the parts of a conversion that takes long.

    Raises:
        ValueError: The color space cannot be encoded.
        OSError: It needs OpenImageIO's Python module, which is missing.
    """
    return _convert(picture, linear, check, decode=False)


def automatic_bounds(linear: FloatArray, *, is_integer: bool) -> tuple[float, float | None]:
    """Returns the range of light: 0 to 1 for integers, else 0 and up; wider where the image is."""
    finite = np.isfinite(linear)
    low = float(linear.min(where=finite, initial=0.0))
    return low, float(linear.max(where=finite, initial=1.0)) if is_integer else None


def _why_empty(image: bpy.types.Image) -> str:
    if not image.filepath:
        return "found no pixels"
    path = bpy.path.abspath(image.filepath, library=image.library)
    if os.path.isfile(path):
        return f"found no pixels; its file '{path}' cannot be read as a picture"
    return f"found no pixels (file '{image.filepath}'); is its file missing?"


def _encoding(image: bpy.types.Image, linear_space: str) -> Encoding:
    space = image.colorspace_settings
    if image.is_float or space.is_data or space.name == linear_space:
        return Encoding.NONE
    if space.name == "sRGB" and linear_space in _LINEAR_REC709_NAMES:
        return Encoding.SRGB
    return Encoding.OCIO


def _convert(picture: Picture, pixels: FloatArray, check: Check, *, decode: bool) -> FloatArray:
    if picture.encoding is Encoding.NONE:
        return pixels
    if picture.encoding is Encoding.SRGB:
        return prefilter.to_linear(pixels) if decode else prefilter.to_srgb(pixels)
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


def _ocio_config() -> str:
    folder = bpy.utils.system_resource("DATAFILES", path="colormanagement")
    return os.environ.get("OCIO") or os.path.join(folder, "config.ocio")


def scene_linear_name() -> str:
    """Returns the name of the scene-linear space, which is what new float images have."""
    probe = bpy.data.images.new("prefilter probe", 1, 1, float_buffer=True)
    try:
        return probe.colorspace_settings.name
    finally:
        bpy.data.images.remove(probe)
