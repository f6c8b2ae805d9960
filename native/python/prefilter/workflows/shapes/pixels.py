# SPDX-License-Identifier: GPL-3.0-or-later

"""Conversion of coverage and associated colors to pixels of images and files."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import prefilter

from ...files import staging
from ...options.colors import Color
from ...options.shapes import RasterizeSettings
from ..alpha import associated, at_most_opaque, unassociated
from ..files import pictures
from ..progress import Progress, go_on, share

FloatArray = NDArray[np.float32]

_ROWS_AT_ONCE = 64


@dataclass(frozen=True)
class Pixels:
    """Scene-linear pixels of an image or a file.

    Attributes:
        values: (height, width, 1, 3 or 4), row 0 at the bottom: a mask, opaque colors, or colors
            with alpha.
        is_straight: Whether colors are not multiplied by alpha.
        color: One straight color for all pixels, with `values` as alpha; None otherwise.
    """

    values: FloatArray
    is_straight: bool
    color: Sequence[float] | None = None

    @property
    def channels(self) -> int:
        """1 for a mask, 3 for opaque colors, 4 for colors with alpha."""
        return self.values.shape[2] if self.color is None else 4

    @property
    def is_mask(self) -> bool:
        """Whether the values are a mask instead of colors."""
        return self.channels == 1

    def floats(self) -> FloatArray:
        """Returns (height, width, channels) values."""
        if self.color is None:
            return self.values
        pixels = np.empty((*self.values.shape[:2], 4), np.float32)
        pixels[..., :3] = self.color
        pixels[..., 3:] = self.values
        return pixels

    def encoded(self, kind: type[np.uint8] | type[np.uint16]) -> NDArray[Any]:
        """Returns integers, sRGB-encoded unless they are a mask."""
        if self.color is None:
            return _whole(self.values if self.is_mask else prefilter.to_srgb(self.values), kind)
        pixels = np.empty((*self.values.shape[:2], 4), kind)
        color = np.array([[self.color]], np.float32)
        pixels[..., :3] = _whole(prefilter.to_srgb(color), kind)
        pixels[..., 3:] = _whole(self.values, kind)
        return pixels


def finished(
    raster: FloatArray,
    color: Color | None,
    settings: RasterizeSettings,
    *,
    light: str,
    is_straight: bool,
    progress: Progress,
) -> Pixels:
    """Returns the pixels according to the settings.

    Args:
        raster: (height, width, 1) coverage, or (height, width, 4) associated colors with alpha.
            Values may overshoot, as many filters do. The array is overwritten.
        color: The color of the shapes, if the raster is coverage.
        settings: Colors, background and bleeding.
        light: The encoding of the raster's colors, in which they are blended with a background:
            "linear" or "srgb".
        is_straight: Whether the result's colors are not multiplied by alpha.
        progress: Called with the fraction done.

    Raises:
        prefilter.Cancelled: `progress` returned False.
    """
    if settings.color != "material":
        raster, color = raster[..., -1:], (1.0, 1.0, 1.0, 1.0)
    if color is not None:
        np.clip(raster, 0.0, 1.0, out=raster)
        if settings.color == "mask":
            return Pixels(raster, is_straight)
        if settings.background == "transparent":
            return _of_one_color(raster, color, settings, is_straight=is_straight)
        raster = raster * np.array([*color[:3], 1.0], np.float32)
    else:
        raster = at_most_opaque(np.maximum(raster, 0.0))
    go_on(progress, 0.3)
    is_opaque = False
    if settings.background == "color":
        *rgb, alpha = settings.background_color
        if light == "srgb":
            rgb = prefilter.to_srgb(np.array([[rgb]], np.float32))[0, 0].tolist()
        behind = np.array([*(alpha * component for component in rgb), alpha], np.float32)
        raster = raster + (1.0 - raster[..., 3:]) * behind
        is_opaque = alpha == 1.0
    if light == "srgb":
        raster = _decoded(raster)
    if is_opaque:
        return Pixels(np.ascontiguousarray(raster[..., :3]), is_straight)
    if not is_straight:
        return Pixels(raster, is_straight)
    straight = unassociated(raster)
    if settings.use_bleed:
        straight = prefilter.fill_transparent(
            straight, progress=share(progress, 0.3, 1.0), threads=settings.threads
        )
    return Pixels(straight, is_straight)


def _decoded(raster: FloatArray) -> FloatArray:
    """Decodes sRGB colors with associated alpha; the result has associated alpha too."""
    straight = unassociated(raster)
    straight[..., :3] = prefilter.to_linear(straight[..., :3])
    return associated(straight)


def _of_one_color(
    coverage: FloatArray, color: Color, settings: RasterizeSettings, *, is_straight: bool
) -> Pixels:
    """Returns one color with coverage as alpha; bleeding extends the color everywhere."""
    if is_straight and settings.use_bleed:
        return Pixels(coverage, is_straight, color[:3])
    values = np.empty((*coverage.shape[:2], 4), np.float32)
    visible = coverage > 0.0 if is_straight else coverage
    np.multiply(visible, np.array(color[:3], np.float32), out=values[..., :3])
    values[..., 3:] = coverage
    return Pixels(values, is_straight)


def _whole(values: FloatArray, kind: type[np.uint8] | type[np.uint16]) -> NDArray[Any]:
    """Converts [0, 1] to integers, rounded."""
    most = np.float32(np.iinfo(kind).max)
    pixels = np.empty(values.shape, kind)
    # In bands: temporary arrays of a whole image would cost more than the arithmetic.
    for start in range(0, len(values), _ROWS_AT_ONCE):
        band = np.clip(values[start : start + _ROWS_AT_ONCE], np.float32(0.0), np.float32(1.0))
        band *= most
        band += np.float32(0.5)
        pixels[start : start + _ROWS_AT_ONCE] = band
    return pixels


def stage(
    target: Path,
    pixels: Pixels,
    settings: RasterizeSettings,
    metadata: Mapping[str, str] | None = None,
) -> staging.StagedFile:
    """Stages a picture file: PNG with 8 bits, or 16 for float pixel types, or OpenEXR.

    Args:
        target: The file.
        pixels: The picture.
        settings: The pixel type.
        metadata: Key-value pairs to store in the file.

    Raises:
        OSError: The file cannot be written.
    """
    values: NDArray[Any]
    if target.suffix.lower() == ".png":
        values = pixels.encoded(np.uint8 if settings.pixel_type == "byte" else np.uint16)
    else:
        values = pixels.floats()
    return pictures.stage(
        target,
        values,
        is_data=pixels.is_mask,
        is_half=settings.pixel_type != "float",
        metadata=metadata,
    )
