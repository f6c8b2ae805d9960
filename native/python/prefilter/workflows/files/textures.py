# SPDX-License-Identifier: GPL-3.0-or-later

"""Mip-mapped texture files for renderers.

* OpenEXR: scene-linear, associated alpha, 16-bit floats unless 32 are requested.
* TIFF (.tif, .tiff, .tx): a byte image keeps 8 bits and its color space, a float image becomes
  scene-linear 32-bit floats; associated alpha, as texture readers expect.

A file always holds every level down to 1 x 1, in tiles of 64 x 64. The library writes OpenEXR files
and OpenImageIO writes TIFF files; `engines` writes the files for engines.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np

import prefilter

from ...files.staging import StagedFile, stage_bytes, stage_with
from .. import alpha, openimageio, space_names
from .. import picture as images
from ..picture import FloatArray, Picture
from ..wording import Sentence
from . import target_files
from .pictures import exr_attributes, in_file_channels

_KNOWN_BEFORE = {
    space_names.SRGB: "sRGB",
    space_names.REC709_LINEAR: "lin_rec709",
    space_names.DATA: "raw",
}
"""Names of color spaces that all versions of OpenImageIO know."""
_WRAP_MODES = {"repeat": "periodic", "clamp": "clamp", "border": "black"}


def display_name(target: Path) -> str:
    """Returns a file, or the numbered files of all levels, for messages."""
    if target.suffix.lower() != ".png":
        return f"'{target}'"
    return Sentence("'{}' and so on", target_files.numbered(target, 0))


def keeps_encoding(target: Path) -> bool:
    """Tells whether a file may hold levels in the encoding of the picture."""
    return target.suffix.lower() != ".exr"


def stage(
    target: Path,
    picture: Picture,
    linear_levels: Sequence[FloatArray],
    stored_levels: Sequence[FloatArray],
    wrap: tuple[str, str],
    check: openimageio.Check,
    *,
    half: bool = True,
    metadata: Mapping[str, str] | None = None,
    threads: int = 0,
) -> StagedFile:
    """Writes a mip-mapped file beside its target.

    Args:
        target: A path from `check_target`.
        picture: Level 0.
        linear_levels: Levels 1, 2, ..., scene-linear, row 0 at the bottom.
        stored_levels: The same in the encoding of the picture; needed only if `keeps_encoding`.
        wrap: Wrap modes in u and v.
        check: Called before each level, at least.
        half: Whether OpenEXR gets 16-bit floats instead of 32-bit ones.
        metadata: Key-value pairs to store in the file.
        threads: How many threads to use for OpenEXR; 0 for all.

    Raises:
        OSError: The file cannot be written.
    """
    wrap_modes = ",".join(_WRAP_MODES[mode] for mode in wrap)
    if not keeps_encoding(target):
        attributes = {"wrapmodes": wrap_modes, **(metadata or {})}
        return _stage_exr(target, picture, linear_levels, attributes, check, half, threads)
    keep_bytes = not picture.is_float
    levels = stored_levels if keep_bytes else linear_levels
    if keep_bytes and not picture.alpha_is_straight:
        full = picture.texels
    else:
        full = picture.stored if keep_bytes else images.scene_linear(picture, check)
    is_gray = _is_gray(picture, [full, *levels])
    color_space = _color_space(picture, keep_bytes)
    told = {"colorInteropID": color_space, **(metadata or {})}
    write = partial(
        openimageio.write_texture,
        levels=[_file_pixels(picture, level, is_gray=is_gray) for level in (full, *levels)],
        pixel_type="uint8" if keep_bytes else "float",
        color_space=_KNOWN_BEFORE.get(color_space, color_space),
        wrap_modes=wrap_modes,
        has_alpha=picture.alpha_is_coverage,
        check=check,
        # TIFF files have no custom attributes that all readers preserve.
        description=" ".join(f"{key}={value}" for key, value in told.items()),
    )
    return stage_with(target, write)


def _stage_exr(
    target: Path,
    picture: Picture,
    linear_levels: Sequence[FloatArray],
    more: Mapping[str, str],
    check: openimageio.Check,
    half: bool,
    threads: int,
) -> StagedFile:
    def go_on(_: float) -> bool:
        check()
        return True

    full, encoding = images.light_or_bytes(picture, check)
    is_gray = _is_gray(picture, [full, *linear_levels])
    space = space_names.DATA if picture.is_data else picture.linear_space
    attributes = {
        "textureformat": "Plain Texture",
        **exr_attributes(space),
        **more,
    }
    kind = "independent"
    if picture.alpha_is_coverage:
        kind = "straight" if picture.alpha_is_straight else "premultiplied"
    write = partial(
        prefilter.write_exr,
        levels=[in_file_channels(level, is_gray=is_gray) for level in (full, *linear_levels)],
        format="half" if half else "float",
        encoding=cast("Any", encoding),
        alpha=cast("Any", kind),
        attributes=attributes,
        chromaticities=None if picture.is_data else space_names.chromaticities_of(space),
        progress=go_on,
        threads=threads,
    )
    return stage_bytes(target, write)


def _is_gray(picture: Picture, levels: Sequence[images.Texels]) -> bool:
    """Tells whether all levels can be stored with one channel for all colors."""
    return picture.is_gray and all(
        in_file_channels(level, is_gray=True).shape[2] < 3 for level in levels
    )


def _file_pixels(picture: Picture, level: images.Texels, *, is_gray: bool) -> images.Texels:
    """Returns a level with associated alpha and rows from the top."""
    if picture.alpha_is_straight:
        level = alpha.associated(level)
    return np.ascontiguousarray(in_file_channels(level, is_gray=is_gray)[::-1])


def _color_space(picture: Picture, keep_bytes: bool) -> str:
    if picture.is_data:
        return space_names.DATA
    is_encoded = keep_bytes and picture.encoding is not images.Encoding.NONE
    name = picture.colorspace if is_encoded else picture.linear_space
    # In a description, a space would end the name.
    return space_names.interop_name(name) or name.replace(" ", "_")
