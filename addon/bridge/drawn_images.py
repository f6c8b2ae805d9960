# SPDX-License-Identifier: GPL-3.0-or-later

"""Image datablocks drawn by Prefilter: new ones, and updates in place."""

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from .images import FloatArray, scene_linear_name

_SRGB, _DATA = "sRGB", "Non-Color"


@dataclass(frozen=True)
class Drawing:
    """Contents of an image datablock.

    Attributes:
        width: Width in pixels.
        height: Height in pixels.
        png: Contents as a PNG file; None for floats.
        floats: (height, width, 4), row 0 at the bottom; None for a PNG file.
        is_half: Whether floats have 16 bits.
        is_data: Whether the values are not colors.
        alpha_mode: Alpha mode of the datablock.
    """

    width: int
    height: int
    png: bytes | None
    floats: FloatArray | None
    is_half: bool
    is_data: bool
    alpha_mode: str


def new_image(name: str, drawing: Drawing) -> bpy.types.Image:
    """Makes a packed image datablock; Blender adds a number to a name that is taken.

    It gets a fake user, as Blender does not save unused datablocks.
    """
    image = bpy.data.images.new(name, 1, 1, alpha=True)
    image.use_fake_user = True
    try:
        draw_into(image, drawing)
    except BaseException:
        bpy.data.images.remove(image)
        raise
    return image


def draw_into(image: bpy.types.Image, drawing: Drawing) -> None:
    """Replaces the pixels of an image datablock, whatever its size and type, and packs them.

    Raises:
        OSError: Blender cannot take the pixels.
    """
    try:
        # Only generated images may change their size and type.
        image.source = "GENERATED"
        image.generated_type = "BLANK"
        image.generated_width, image.generated_height = drawing.width, drawing.height
        image.use_generated_float = drawing.floats is not None
        image.alpha_mode = drawing.alpha_mode
        image.colorspace_settings.name = _colorspace(drawing)
        if drawing.png is not None:
            image.pack(data=drawing.png, data_len=len(drawing.png))
            image.source = "FILE"
        else:
            assert drawing.floats is not None
            image.use_half_precision = drawing.is_half
            values: NDArray[np.float32] = np.ascontiguousarray(drawing.floats, np.float32)
            image.pixels.foreach_set(values.ravel())
            image.update()
            image.pack()
    except (RuntimeError, TypeError) as error:
        raise OSError(f"image '{image.name}': cannot take the pixels: {error}") from error
    image.update_tag()


def _colorspace(drawing: Drawing) -> str:
    if drawing.is_data:
        return _DATA
    return _SRGB if drawing.png is not None else scene_linear_name()
