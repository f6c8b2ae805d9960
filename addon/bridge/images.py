"""Image datablocks to scene-linear arrays, and levels back to image datablocks.

What Blender keeps in `Image.pixels` (rows from the bottom, always four channels):

* a byte image: display values of the image's colour space, with straight alpha. Even with the
  alpha mode Premultiplied: Blender divides by alpha on load;
* a float image: scene-linear values, with associated alpha. Blender converts on load.

Alpha is coverage unless the alpha mode is Channel Packed or None or the colour space is data; then
the four channels are independent.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from . import openimageio

FloatArray = NDArray[np.float32]

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
_LINEAR_REC709_NAMES = frozenset({"Linear", "Linear Rec.709"})
_MAX_NAME_BYTES = 63


class Encoding(Enum):
    """How stored colour relates to scene-linear colour."""

    NONE = "none"
    SRGB = "srgb"
    OCIO = "ocio"


@dataclass(frozen=True)
class Picture:
    """The pixels of an image datablock, and what is needed to read them as light.

    Attributes:
        name: The datablock's name.
        stored: (height, width, 3 or 4) values as Blender keeps them, row 0 at the bottom. An alpha
            that is 1 everywhere is left out.
        is_float: Whether the datablock holds floats instead of bytes.
        encoding: How `stored` relates to scene-linear values.
        colorspace: The name of the datablock's colour space.
        is_data: Whether the colour space says that the values are no colours.
        alpha_mode: The datablock's alpha mode.
        linear_space: The name of Blender's scene-linear space.
        ocio_config: Path of Blender's OpenColorIO configuration.
    """

    name: str
    stored: FloatArray
    is_float: bool
    encoding: Encoding
    colorspace: str
    is_data: bool
    alpha_mode: str
    linear_space: str
    ocio_config: str

    @property
    def alpha_is_coverage(self) -> bool:
        """Whether there is an alpha channel that says how much of a texel is covered."""
        independent = self.is_data or self.alpha_mode in {"CHANNEL_PACKED", "NONE"}
        return self.stored.shape[2] == 4 and not independent

    @property
    def alpha_is_straight(self) -> bool:
        """Whether colours have to be multiplied by alpha before they are filtered."""
        return self.alpha_is_coverage and not self.is_float


def find(name: str) -> bpy.types.Image:
    """Returns the image datablock of that name.

    Raises:
        ValueError: There is none.
    """
    image = bpy.data.images.get(name)
    if image is None:
        known = ", ".join(f"'{other.name}'" for other in bpy.data.images) or "no image"
        raise ValueError(f"image: found no image named '{name}'; this file has {known}")
    return image


def read(image: bpy.types.Image) -> Picture:
    """Copies an image datablock's pixels.

    Raises:
        ValueError: The datablock is no single still image, or it has no pixels.
    """
    kind = _KIND_OF_SOURCE.get(image.source) or _KIND_OF_TYPE.get(image.type)
    if kind is not None:
        raise ValueError(f"image '{image.name}': found {kind}; a single still image is needed")
    width, height = image.size
    count = len(image.pixels)
    if width == 0 or height == 0 or count == 0:
        path = f" (file '{image.filepath}')" if image.filepath else ""
        raise ValueError(f"image '{image.name}': found no pixels{path}; is its file missing?")
    pixels = np.empty(count, np.float32)
    image.pixels.foreach_get(pixels)
    stored = pixels.reshape(height, width, count // (width * height))
    if stored.shape[2] == 4 and np.all(stored[..., 3] == 1.0):
        stored = np.ascontiguousarray(stored[..., :3])
    space = image.colorspace_settings
    linear_space = _scene_linear_name()
    return Picture(
        name=image.name,
        stored=stored,
        is_float=image.is_float,
        encoding=_encoding(image, linear_space),
        colorspace=space.name,
        is_data=space.is_data,
        alpha_mode=image.alpha_mode,
        linear_space=linear_space,
        ocio_config=_ocio_config(),
    )


def scene_linear(picture: Picture) -> FloatArray:
    """Returns the picture's values as light, with alpha as it is stored.

    Raises:
        ValueError: The colour space cannot be decoded.
        OSError: It needs OpenImageIO's Python module, which is missing.
    """
    return _convert(picture, picture.stored, decode=True)


def encoded(picture: Picture, linear: FloatArray) -> FloatArray:
    """Returns scene-linear values as `picture` stores them: the inverse of `scene_linear`.

    Raises:
        ValueError: The colour space cannot be encoded.
        OSError: It needs OpenImageIO's Python module, which is missing.
    """
    return _convert(picture, linear, decode=False)


def write_levels(picture: Picture, levels: Sequence[FloatArray]) -> list[str]:
    """Writes levels 1 and up as packed image datablocks named `<image>.mip1`, `<image>.mip2` ...

    An image that already has such a name is updated in place, so that materials that show it stay
    linked. Deeper levels of an earlier bake are left as they are. Every image keeps a fake user, as
    Blender saves no unused datablock.

    A byte level has the picture's colour space, and straight alpha where the picture's is
    Premultiplied. A float level is scene-linear (or data, like the picture), with associated alpha.
    Only these survive packing, saving and loading: Blender's packing does not convert colours, and
    its loading does.

    Args:
        picture: Level 0.
        levels: Levels 1, 2, ... in the encoding of `picture.stored`.

    Returns:
        The names of the images.
    """
    if not picture.is_float:
        colorspace = picture.colorspace
        alpha_mode = "STRAIGHT" if picture.alpha_mode == "PREMUL" else picture.alpha_mode
    else:
        colorspace = picture.colorspace if picture.is_data else picture.linear_space
        alpha_mode = "PREMUL" if picture.alpha_mode == "STRAIGHT" else picture.alpha_mode
    names = []
    for number, level in enumerate(levels, start=1):
        height, width = level.shape[:2]
        image = _level_image(level_name(picture.name, number), width, height, picture.is_float)
        image.colorspace_settings.name = colorspace
        image.alpha_mode = alpha_mode
        image.pixels.foreach_set(_with_alpha(level).ravel())
        image.update()
        image.pack()
        names.append(image.name)
    return names


def level_name(image_name: str, number: int) -> str:
    """Returns the name of the image that holds a level; the base is cut to fit Blender's limit."""
    suffix = f".mip{number}"
    base = image_name.encode()[: _MAX_NAME_BYTES - len(suffix)].decode(errors="ignore")
    return base + suffix


def _encoding(image: bpy.types.Image, linear_space: str) -> Encoding:
    space = image.colorspace_settings
    if image.is_float or space.is_data or space.name == linear_space:
        return Encoding.NONE
    if space.name == "sRGB" and linear_space in _LINEAR_REC709_NAMES:
        return Encoding.SRGB
    return Encoding.OCIO


def _convert(picture: Picture, pixels: FloatArray, *, decode: bool) -> FloatArray:
    if picture.encoding is Encoding.NONE:
        return pixels
    if picture.encoding is Encoding.SRGB:
        return prefilter.to_linear(pixels) if decode else prefilter.to_srgb(pixels)
    spaces = (picture.colorspace, picture.linear_space)
    source, target = spaces if decode else reversed(spaces)
    colors = np.ascontiguousarray(pixels[..., :3])
    try:
        converted = openimageio.color_convert(colors, source, target, picture.ocio_config)
    except ValueError as error:
        raise ValueError(
            f"image '{picture.name}': cannot convert its colour space '{picture.colorspace}': "
            f"{error}"
        ) from error
    result = pixels.copy()
    result[..., :3] = converted
    return result


def _ocio_config() -> str:
    folder = bpy.utils.system_resource("DATAFILES", path="colormanagement")
    return os.environ.get("OCIO") or os.path.join(folder, "config.ocio")


def _scene_linear_name() -> str:
    """Returns the name of the scene-linear space, which is what new float images have."""
    probe = bpy.data.images.new("prefilter probe", 1, 1, float_buffer=True)
    try:
        return probe.colorspace_settings.name
    finally:
        bpy.data.images.remove(probe)


def _level_image(name: str, width: int, height: int, is_float: bool) -> bpy.types.Image:
    image = next((i for i in bpy.data.images if i.name == name and i.library is None), None)
    if image is None:
        image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    image.source = "GENERATED"
    image.generated_width = width
    image.generated_height = height
    image.use_generated_float = is_float
    image.use_fake_user = True
    return image


def _with_alpha(pixels: FloatArray) -> FloatArray:
    if pixels.shape[2] == 4:
        return np.ascontiguousarray(pixels, np.float32)
    rgba = np.ones((*pixels.shape[:2], 4), np.float32)
    rgba[..., :3] = pixels
    return rgba
