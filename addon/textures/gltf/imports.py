# SPDX-License-Identifier: GPL-3.0-or-later

"""Converts the KTX 2 textures of a glTF import to pictures that Blender can read."""

import base64
import io
from typing import Any

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray
from prefilter.workflows.files import png

from ...bridge import images, level_images
from ...core.outcome import FAILURES, reason

_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"


class Import:
    """The textures of one import."""

    def __init__(self, *, keep_levels: bool) -> None:
        """Stores whether to import levels 1, 2, ... as images too."""
        self._keep_levels = keep_levels
        self._levels: dict[int, list[NDArray[np.uint8]]] = {}
        self._imported: list[tuple[bpy.types.Image, list[NDArray[np.uint8]]]] = []

    def replace_image(self, image: Any, gltf: Any) -> None:
        """Replaces a KTX 2 file by a PNG file, before Blender reads it."""
        data = _data(image, gltf)
        if not data.startswith(_IDENTIFIER):
            return
        name = image.name or _name(image.uri)
        try:
            levels, _ = prefilter.read_ktx2(io.BytesIO(data))
            if levels[0].dtype != np.uint8:
                raise ValueError(f"holds {levels[0].dtype}; bytes are needed, as glTF has them")
        except FAILURES as error:
            gltf.log.error(f"Prefilter: texture '{name}' cannot be read: {reason(error)}")
            return
        levels = [_with_colors(level) for level in levels]
        picture = base64.b64encode(png.encoded(levels[0])).decode("ascii")
        image.uri, image.buffer_view = f"data:image/png;base64,{picture}", None
        image.mime_type, image.name = "image/png", name
        if self._keep_levels:
            self._levels[id(image)] = levels[1:]

    def add_image(self, image: Any, blender_image: bpy.types.Image | None) -> None:
        """Stores Blender's image with its levels, until its color space is known."""
        levels = self._levels.pop(id(image), None)
        if blender_image is not None and levels:
            self._imported.append((blender_image, levels))

    def keep_levels(self, gltf: Any) -> None:
        """Makes level images, as a bake does."""
        for image, levels in self._imported:
            try:
                picture = images.read(image)
                floats = [level.astype(np.float32) / np.float32(255) for level in levels]
                level_images.stage_levels(picture, floats).commit()
            except FAILURES as error:
                gltf.log.error(
                    f"Prefilter: the levels of '{image.name}' are not kept: {reason(error)}"
                )
        self._imported.clear()


def show_ktx2(gltf: Any) -> None:
    """Sets the source of textures without a fallback picture to that of KHR_texture_basisu."""
    for texture in gltf.data.textures or ():
        extension = (texture.extensions or {}).get("KHR_texture_basisu")
        if texture.source is None and isinstance(extension, dict):
            texture.source = extension.get("source")


def _data(image: Any, gltf: Any) -> bytes:
    """Returns the file of an image; empty if it is not a KTX 2 file."""
    from io_scene_gltf2.io.imp.gltf2_io_binary import BinaryData

    is_elsewhere = image.uri is not None and not image.uri.startswith("data:")
    if is_elsewhere and not image.uri.lower().endswith(".ktx2"):
        return b""
    data = BinaryData.get_image_data(gltf, gltf.data.images.index(image))
    if data is None or bytes(data[: len(_IDENTIFIER)]) != _IDENTIFIER:
        return b""
    return bytes(data)


def _name(uri: str | None) -> str | None:
    if uri is None or uri.startswith("data:"):
        return None
    return uri.rpartition("/")[2].rpartition(".")[0]


def _with_colors(level: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Returns a level with three channels: one channel becomes gray, two get a blue of 0."""
    height, width, channels = level.shape
    if channels >= 3:
        return level
    colors = np.zeros((height, width, 3), np.uint8)
    colors[..., : 3 if channels == 1 else 2] = level
    return colors
