# SPDX-License-Identifier: GPL-3.0-or-later

"""Pixels of image datablocks as arrays, and their color spaces.

`Image.pixels` has rows from the bottom, and always four channels:

* byte images: display values of the image's color space, with straight alpha, even for the alpha
  mode Premultiplied: Blender divides by alpha on load;
* float images: scene-linear values, with associated alpha. Blender converts on load.

Alpha is coverage unless the alpha mode is Channel Packed or None or the color space is data; then
the four channels are independent. A material may still use the alpha of a Channel Packed image as
coverage, as those of Blender's glTF importer do. Colors are straight then, even of float images,
as Channel Packed images are not converted on load.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from prefilter.files.claims import temporary_folder
from prefilter.workflows.picture import (
    LINEAR_REC709_NAMES,
    Encoding,
    FloatArray,
    Picture,
    Texels,
    automatic_bounds,
    capped,
    encoded,
    light_or_bytes,
    scene_linear,
    with_coverage,
    without_fourth,
)

from ..core.wording import listed
from . import openimageio

__all__ = (
    "Encoding",
    "FloatArray",
    "Picture",
    "Texels",
    "automatic_bounds",
    "capped",
    "check_untiled",
    "encoded",
    "files_of",
    "find",
    "kind_that_is_no_still",
    "kind_that_is_not_read",
    "light_or_bytes",
    "load",
    "read",
    "read_tile",
    "scene_linear",
    "scene_linear_name",
    "tile_numbers",
    "tile_path",
    "with_coverage",
)

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
_BAND_SIZE = 1 << 20
"""Values converted at once."""


def find(name: str) -> bpy.types.Image:
    """Finds an image datablock by name.

    Raises:
        ValueError: There is none.
    """
    image = bpy.data.images.get(name)
    if image is None:
        known = listed(other.name for other in bpy.data.images) or "no image"
        raise ValueError(f"image: found no image named '{name}'; this file has {known}")
    return image


def load(argument: str, path: str, *, is_data: bool) -> bpy.types.Image:
    """Loads a picture file, or returns the existing datablock of it, unchanged.

    Args:
        argument: Name of the path in messages.
        path: The file.
        is_data: Whether its values are not colors.

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
        ValueError: The datablock is not a single still image, or it has no pixels.
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
        texels = without_fourth(texels)
        channels = 3
    space = image.colorspace_settings
    linear_space = scene_linear_name()
    file = _file_of(image)
    picture = Picture(
        name=image.name,
        full_name=image.name_full,
        texels=texels.reshape(height, width, channels),
        is_float=image.is_float,
        is_integer=not image.is_float or file.is_integer,
        encoding=_encoding(image, linear_space),
        colorspace=space.name,
        is_data=space.is_data,
        alpha_mode=image.alpha_mode,
        linear_space=linear_space,
        ocio_config=_ocio_config(),
        is_gray=file.is_gray,
    )
    if not was_loaded and image.source == "FILE" and not image.is_dirty:
        # Free the pixels that were loaded only for this; Blender reloads them if needed.
        image.buffers_free()
    return picture


def _as_bytes(pixels: FloatArray) -> NDArray[np.uint8]:
    """Converts values of a byte image, (n,), back to bytes, in the memory of the floats.

    Large images leave no memory for a second array: bands are copied, and the bytes written over
    floats that were read before; then the memory is shrunk.
    """
    count = len(pixels)
    narrow = pixels.view(np.uint8)
    for start in range(0, count, _BAND_SIZE):
        band = pixels[start : start + _BAND_SIZE] * np.float32(255)
        narrow[start : start + len(band)] = np.rint(band, out=band)
    del narrow
    pixels.resize(-(-count // 4), refcheck=False)
    return pixels.view(np.uint8)[:count]


def _file_of(image: bpy.types.Image) -> openimageio.ValueKind:
    """Properties of an image's file: a 16-bit PNG has integers, which are floats in Blender."""
    if image.source != "FILE":
        return openimageio.ValueKind(is_integer=False, is_gray=False)
    if image.packed_file is None:
        return openimageio.value_kind(bpy.path.abspath(image.filepath, library=image.library))
    with temporary_folder() as folder:
        copy = folder / "picture"
        copy.write_bytes(image.packed_file.data)
        return openimageio.value_kind(str(copy))


def check_untiled(image: bpy.types.Image) -> None:
    """Raises ValueError where the image has UDIM tiles."""
    if image.source == "TILED":
        raise ValueError(f"image '{image.name}': has UDIM tiles; an image without tiles is needed")


def tile_numbers(image: bpy.types.Image) -> list[int]:
    """Returns the numbers of a UDIM image's tiles; none for another image."""
    return [tile.number for tile in image.tiles] if image.source == "TILED" else []


def read_tile(image: bpy.types.Image, number: int) -> Picture:
    """Copies the pixels of a UDIM tile from its file, as Blender's API has one tile's only.

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
    """Returns the files that a still image or a UDIM image is rendered from.

    Returns:
        Absolute paths by tile number; the key is None for an image without tiles.

    Raises:
        ValueError: The image is not rendered from files, or a file is missing.
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
    """Describes an image that is not a still from a file, packed or not; None for others."""
    kind = _KIND_OF_TYPE.get(image.type)
    if kind is None and image.source not in {"FILE", "TILED"}:
        kind = _KIND_OF_SOURCE.get(image.source, "a generated image, which has no file")
    return kind


def kind_that_is_not_read(image: bpy.types.Image) -> str | None:
    """Describes an image whose pixels or tiles cannot be read; None for others."""
    if image.source == "TILED":
        return None
    return _KIND_OF_SOURCE.get(image.source) or _KIND_OF_TYPE.get(image.type)


@contextmanager
def _tile_file(image: bpy.types.Image, number: int, who: str) -> Iterator[str]:
    """Yields the path of a tile's file, a temporary file if the tile is packed."""
    path = str(tile_path(image, number))
    packed = next((file for file in image.packed_files if file.tile_number == number), None)
    if packed is not None:
        with temporary_folder() as folder:
            copy = folder / os.path.basename(path)
            copy.write_bytes(packed.packed_file.data)
            yield str(copy)
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
    if space.name == "sRGB" and linear_space in LINEAR_REC709_NAMES:
        return Encoding.SRGB
    return Encoding.OCIO


def _ocio_config() -> str:
    folder = bpy.utils.system_resource("DATAFILES", path="colormanagement")
    return os.environ.get("OCIO") or os.path.join(folder, "config.ocio")


def scene_linear_name() -> str:
    """Returns the name of the scene-linear space, the default of new float images."""
    probe = bpy.data.images.new("prefilter probe", 1, 1, float_buffer=True)
    try:
        return probe.colorspace_settings.name
    finally:
        bpy.data.images.remove(probe)
