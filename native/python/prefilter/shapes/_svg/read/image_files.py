# SPDX-License-Identifier: GPL-3.0-or-later

"""Raster images: PNG, JPEG, GIF and WebP, decoded by Pillow or OpenImageIO."""

import io
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ....files.claims import temporary_folder

if TYPE_CHECKING:
    from ....workflows.openimageio import Metadata

Texels = npt.NDArray[np.uint8]

MAX_TEXELS = 1 << 25
_COLOR_MODELS = frozenset({"CMYK", "LAB"})
_GRAY_MODES = frozenset({"1", "L", "LA"})
"""Modes of Pillow."""


class ImageError(Exception):
    """An image cannot be read; the message says why."""


def decode_image(data: bytes) -> Texels:
    """Decodes an image; of an animation, the first frame.

    Returns:
        (height, width, 4): red, green, blue and straight alpha; top row first.

    Raises:
        PictureError: ImageError: The image cannot be read.
    """
    width, height = image_size(data)
    if width * height > MAX_TEXELS:
        raise ImageError(f"as it has {width} x {height} pixels; the limit is {MAX_TEXELS}")
    try:
        pillow = import_module("PIL.Image")
    except ImportError:
        texels, metadata, is_gray = _by_openimageio(data)
    else:
        texels, metadata, is_gray = _by_pillow(pillow, data)
    return _upright_in_srgb(texels, data, metadata, is_gray=is_gray)


def _by_pillow(pillow: Any, data: bytes) -> "tuple[Texels, Metadata, bool]":
    from ....workflows.openimageio import Metadata

    try:
        with pillow.open(io.BytesIO(data), formats=("PNG", "JPEG", "GIF", "WEBP")) as file:
            model = file.mode if file.mode in _COLOR_MODELS else ""
            icc = file.info.get("icc_profile") or b""
            metadata = Metadata(file.format.lower(), model=model, icc=icc)
            # Pillow truncates 16 bits instead of rounding.
            if file.mode.startswith("I"):
                gray = np.rint(np.asarray(file, np.float64) / 257.0).clip(0.0, 255.0)
                return _as_rgba(gray.astype(np.uint8)[..., None]), metadata, True
            return np.array(file.convert("RGBA"), np.uint8), metadata, file.mode in _GRAY_MODES
    except (OSError, ValueError, SyntaxError, MemoryError) as error:
        raise ImageError(f"as it cannot be read: {error}") from None


def _by_openimageio(data: bytes) -> "tuple[Texels, Metadata, bool]":
    from ....workflows import openimageio

    try:
        with temporary_folder() as folder:
            path = folder / f"image{image_extension(data)}"
            path.write_bytes(data)
            values, _, metadata, _ = openimageio.read_pixels(path)
    except (OSError, ValueError, MemoryError) as error:
        raise ImageError(f"as it cannot be read: {error}") from None
    if values.dtype != np.uint8:
        values = np.rint(values / 257.0).clip(0.0, 255.0).astype(np.uint8)
    return _as_rgba(values), metadata, values.shape[2] < 3


def _upright_in_srgb(texels: Texels, data: bytes, metadata: "Metadata", *, is_gray: bool) -> Texels:
    """Applies EXIF orientation, and converts from the file's color space to sRGB."""
    from ....workflows import color_spaces, picture_colors
    from ....workflows.files.embedded import read_embedded_from

    embedded = read_embedded_from(io.BytesIO(data))
    try:
        space = picture_colors.space_of(metadata, embedded, is_integer=True, is_gray=is_gray)
    except ValueError as error:
        raise ImageError(f"as {str(error).partition(';')[0]}") from None
    if space is not None and not space.is_srgb:
        light = space.in_rec709(space.decoded(texels[..., :3].astype(np.float32) / np.float32(255)))
        texels[..., :3] = color_spaces.srgb_bytes(light)
    upright = picture_colors.upright(texels, picture_colors.orientation_of(metadata, embedded))
    return np.ascontiguousarray(upright)


def _as_rgba(values: Texels) -> Texels:
    """Expands one to four channels to four."""
    height, width, channels = values.shape
    rgba = np.full((height, width, 4), 255, np.uint8)
    rgba[..., :3] = values[..., :3] if channels > 2 else values[..., :1]
    if channels in (2, 4):
        rgba[..., 3] = values[..., -1]
    return rgba


def image_extension(data: bytes) -> str:
    """Returns the file name extension for an image's signature; empty if unknown."""
    for extension, signature in (
        (".png", b"\x89PNG\r\n\x1a\n"),
        (".jpg", b"\xff\xd8\xff"),
        (".gif", b"GIF8"),
    ):
        if data.startswith(signature):
            return extension
    return ".webp" if data[:4] == b"RIFF" and data[8:12] == b"WEBP" else ""


def image_size(data: bytes) -> tuple[int, int]:
    """Reads width and height from the header, before decompression."""
    if data.startswith(b"\x89PNG"):
        return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
    if data.startswith(b"GIF8"):
        return int.from_bytes(data[6:8], "little"), int.from_bytes(data[8:10], "little")
    if data.startswith(b"RIFF"):
        return _webp_size(data)
    at = 2
    while at + 9 <= len(data) and data[at] == 0xFF:
        kind, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4], "big")
        if 0xC0 <= kind <= 0xCF and kind not in (0xC4, 0xC8, 0xCC):
            height, width = data[at + 5 : at + 7], data[at + 7 : at + 9]
            return int.from_bytes(width, "big"), int.from_bytes(height, "big")
        at += 1 if kind == 0xFF else 2 + length
    return 0, 0


def _webp_size(data: bytes) -> tuple[int, int]:
    kind, body = data[12:16], data[20:30]
    if kind == b"VP8X":
        size = int.from_bytes(body[4:7], "little"), int.from_bytes(body[7:10], "little")
        return size[0] + 1, size[1] + 1
    if kind == b"VP8L":
        bits = int.from_bytes(body[1:5], "little")
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    sides = int.from_bytes(body[6:8], "little"), int.from_bytes(body[8:10], "little")
    return sides[0] & 0x3FFF, sides[1] & 0x3FFF
