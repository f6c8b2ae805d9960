# SPDX-License-Identifier: GPL-3.0-or-later

"""New image datablocks and picture files from arrays."""

import hashlib
from pathlib import Path

import bpy
import numpy as np

from .images import FloatArray, Picture

# Blender's limit is 63 bytes; this leaves space for ".001" if the name is taken.
_MAX_NAME_BYTES = 59
_HASH_DIGITS = 8


def suffixed(image_name: str, ending: str) -> str:
    """Returns `<image>.<ending>`; a base that is too long is cut, and gets a hash."""
    suffix = f".{ending}"
    base = image_name.encode()
    if len(base) + len(suffix) <= _MAX_NAME_BYTES:
        return image_name + suffix
    suffix = f"~{hashlib.sha256(base).hexdigest()[:_HASH_DIGITS]}{suffix}"
    return base[: _MAX_NAME_BYTES - len(suffix)].decode(errors="ignore") + suffix


def new_packed(name: str, like: Picture | None, pixels: FloatArray) -> bpy.types.Image:
    """Makes a packed image datablock with a fake user.

    Args:
        name: Its name; Blender appends a number if it is taken.
        like: Picture with the same format (see `level_images.stage_levels`); None for an sRGB byte
            image.
        pixels: Its values, row 0 at the bottom.
    """
    height, width = pixels.shape[:2]
    is_float = like is not None and like.is_float
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    try:
        _fill_level(image, like, pixels)
    except BaseException:
        bpy.data.images.remove(image)
        raise
    return image


def save_png(path: Path, pixels: FloatArray) -> None:
    """Writes sRGB values, row 0 at the bottom, as a PNG file.

    Raises:
        OSError: The file cannot be written.
    """
    image = new_packed("prefilter picture", None, pixels)
    try:
        image.filepath_raw = str(path)
        image.file_format = "PNG"
        image.save()
    except RuntimeError as error:
        raise OSError(f"file '{path}': cannot be written: {str(error).strip()}") from error
    finally:
        bpy.data.images.remove(image)


def _fill_level(image: bpy.types.Image, picture: Picture | None, level: FloatArray) -> None:
    if picture is None:
        image.colorspace_settings.name = "sRGB"
    elif not picture.is_float:
        image.colorspace_settings.name = picture.colorspace
        image.alpha_mode = "STRAIGHT" if picture.alpha_mode == "PREMUL" else picture.alpha_mode
    else:
        space = picture.colorspace if picture.is_data else picture.linear_space
        image.colorspace_settings.name = space
        image.alpha_mode = "PREMUL" if picture.alpha_mode == "STRAIGHT" else picture.alpha_mode
    image.use_fake_user = True
    image.pixels.foreach_set(_with_alpha(level).ravel())
    image.update()
    image.pack()


def _with_alpha(pixels: FloatArray) -> FloatArray:
    if pixels.shape[2] == 4:
        return np.ascontiguousarray(pixels, np.float32)
    rgba = np.ones((*pixels.shape[:2], 4), np.float32)
    rgba[..., :3] = pixels
    return rgba
