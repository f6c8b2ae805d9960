# SPDX-License-Identifier: GPL-3.0-or-later

"""Images and texts derived from an image: figures, views, copies. Tags name their source."""

import bpy

from .images import FloatArray, Picture
from .new_images import new_packed, suffixed

_PICTURE_KEY = "prefilter_picture_of"
_COPY_KEY = "prefilter_copy_of"
_SUFFIX_KEY = "prefilter_copy_suffix"


def write_picture(
    source: Picture, suffix: str, pixels: FloatArray, *, like_source: bool = False
) -> bpy.types.Image:
    """Makes a packed image named `<source>.<suffix>`, and replaces an earlier one.

    Args:
        source: The image that it is derived from.
        suffix: End of its name.
        pixels: sRGB values for a byte image, unless `like_source`.
        like_source: Whether `pixels` are in the format and encoding of `source`.

    Raises:
        OSError: The image cannot be made.
    """
    name = suffixed(source.name, suffix)
    key = _COPY_KEY if like_source else _PICTURE_KEY
    try:
        image = new_packed(name, source if like_source else None, pixels)
    except RuntimeError as error:
        raise OSError(f"image '{source.name}': cannot make '{name}': {error}") from error
    image[key] = source.full_name
    if like_source:
        image[_SUFFIX_KEY] = suffix
    earlier = bpy.data.images.get(name)
    if earlier is not None and earlier != image and earlier.get(key) == source.full_name:
        earlier.user_remap(image)
        bpy.data.images.remove(earlier)
        image.name = name
    return image


def write_text(source: Picture, suffix: str, text: str) -> bpy.types.Text:
    """Writes a text named `<source>.<suffix>`, over an earlier one."""
    name = suffixed(source.name, suffix)
    block = bpy.data.texts.get(name)
    if block is None or block.get(_PICTURE_KEY) != source.full_name:
        block = bpy.data.texts.new(name)
        block[_PICTURE_KEY] = source.full_name
    block.from_string(text)
    return block


def source_of(image: bpy.types.Image | None) -> bpy.types.Image | None:
    """Returns the source of a picture or a copy; None if it is gone."""
    return pictured(image) or _tagged(image, _COPY_KEY)


def pictured(image: bpy.types.Image | None) -> bpy.types.Image | None:
    """Returns the source of a picture; None if it is gone, or for a copy."""
    return _tagged(image, _PICTURE_KEY)


def copied(image: bpy.types.Image | None, suffix: str) -> bpy.types.Image | None:
    """Returns the source of a copy with this suffix; None if it is gone."""
    if image is None or image.get(_SUFFIX_KEY) != suffix:
        return None
    return _tagged(image, _COPY_KEY)


def _tagged(image: bpy.types.Image | None, key: str) -> bpy.types.Image | None:
    name = image.get(key) if image is not None else None
    if name is None:
        return None
    return next((other for other in bpy.data.images if other.name_full == name), None)
