# SPDX-License-Identifier: GPL-3.0-or-later

"""Texture files for engines: DDS and KTX 2 with all levels, or one PNG for each level.

* A byte image in sRGB or of data keeps its bytes in 8-bit and block formats; straight alpha.
* Other images are sRGB-encoded in these formats, unless they are data.
* Float formats are scene-linear. A float image has associated alpha, and the file says so.
* PNG: a byte image is unchanged; a float image gets 16 bits, sRGB-encoded unless it is data;
  straight alpha.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import prefilter
from prefilter import TexelFormat

from ...files import staging
from ...files.staging import StagedFile
from ..alpha import unassociated
from ..openimageio import Check
from ..picture import Encoding, FloatArray, Picture
from . import png
from .pictures import in_file_channels
from .target_files import has_formats, has_supercompression, numbered

_WRITERS: dict[str, Callable[..., None]] = {
    ".dds": prefilter.write_dds,
    ".ktx2": prefilter.write_ktx2,
}
_CHANNELS = {1: "the red channel", 2: "the red and green channels"}
_CUT_OUT_ALPHA = 0.5


def is_for_engines(target: Path) -> bool:
    """Tells whether `stage` of this module writes files of this type."""
    return target.suffix.lower() in (*_WRITERS, ".png")


def format_warnings(
    picture: Picture,
    target: Path | None,
    texture_format: str,
    threshold: float | None = None,
    *,
    may_lose_channels: bool = False,
    is_stretched: bool = False,
) -> list[str]:
    """Returns warnings about the format of a picture's file.

    Args:
        picture: Level 0.
        target: The file; None for none.
        texture_format: See `stage`.
        threshold: The alpha test's threshold for a cut-out; None for other images.
        may_lose_channels: Whether channels that the format lacks are unused anyway.
        is_stretched: Whether the sides become multiples of `unit_of_sides`.

    Raises:
        ValueError: The picture does not fit the format.
    """
    if target is None or not has_formats(target.name):
        return []
    chosen = _resolved_format(picture, texture_format)
    who = f"Texture Format: {_label(chosen.name)}"
    if not chosen.is_in_dds and not has_supercompression(target.name):
        raise ValueError(f"{who} needs a .ktx2 file; found '{target.name}'")
    has_no_srgb = chosen.channels in _CHANNELS
    if has_no_srgb and not picture.is_float and picture.encoding is not Encoding.NONE:
        raise ValueError(
            f"{who} has no sRGB variant, and image '{picture.name}' has the color space "
            f"{picture.colorspace}; set Non-Color, or choose another format"
        )
    warnings = []
    height, width, _ = picture.shape
    unit = unit_of_sides(picture, target, texture_format)
    if not is_stretched and (width % unit or height % unit):
        warnings.append(
            f"{who} of {width} x {height} texels: readers need sides divisible by {unit}"
        )
    warnings += _lost_channels(picture, chosen, who, threshold, may_lose_channels)
    warnings += _lost_values(picture, chosen, who)
    return warnings


def keeps_range(picture: Picture, target: Path, texture_format: str) -> bool:
    """Tells whether a picture's file can hold values below 0 and above 1."""
    return has_formats(target.name) and _resolved_format(picture, texture_format).keeps_negatives


def unit_of_sides(picture: Picture, target: Path | None, texture_format: str) -> int:
    """Returns the number that the sides must be multiples of for readers of a picture's file.

    Direct3D requires whole blocks, and so do transcoders to its formats.
    """
    if target is None or not has_formats(target.name):
        return 1
    chosen = _resolved_format(picture, texture_format)
    if chosen.block is None or not (chosen.is_in_dds or chosen.is_transcoded):
        return 1
    return max(chosen.block)


def _lost_channels(
    picture: Picture,
    chosen: TexelFormat,
    who: str,
    threshold: float | None,
    may_lose_channels: bool,
) -> list[str]:
    if chosen.channels in _CHANNELS:
        warning = f"{who} keeps only {_CHANNELS[chosen.channels]} of '{picture.name}'"
        return [] if may_lose_channels else [warning]
    if picture.shape[2] < 4 or chosen.alpha == "full":
        return []
    if chosen.alpha == "none" or not picture.alpha_is_coverage:
        is_lost = picture.alpha_is_coverage or not may_lose_channels
        return [f"{who} drops the fourth channel of '{picture.name}'"] if is_lost else []
    if threshold is None:
        return [f"{who} stores only alpha 0 and 1; '{picture.name}' has values in between"]
    if threshold != _CUT_OUT_ALPHA:
        return [f"{who} cuts alpha off at {_CUT_OUT_ALPHA}, not at the threshold {threshold:g}"]
    return []


def _lost_values(picture: Picture, chosen: TexelFormat, who: str) -> list[str]:
    if not picture.is_float:
        if not chosen.is_float or chosen.keeps_negatives:
            return []
        closer = "BC7" if chosen.is_in_dds else "ASTC"
        return [f"{who} is for float images; {closer} is closer to '{picture.name}'"]
    finite = picture.stored[np.isfinite(picture.stored)]
    if finite.size == 0 or chosen.keeps_negatives:
        return []
    if not chosen.is_float and (finite.min() < 0 or finite.max() > 1):
        return [f"{who} clips values of '{picture.name}' outside 0 to 1"]
    if chosen.is_float and finite.min() < 0:
        return [f"{who} clips values of '{picture.name}' below 0"]
    return []


def stage(
    target: Path,
    picture: Picture,
    linear_levels: Sequence[FloatArray],
    stored_levels: Sequence[FloatArray],
    texture_format: str,
    check: Check,
    *,
    effort: str = "normal",
    supercompression: str = "none",
    quality: int | None = None,
    metadata: Mapping[str, str] | None = None,
    threads: int = 0,
) -> list[StagedFile]:
    """Writes a DDS or KTX 2 file, or a PNG for each level, beside the target.

    Args:
        target: A path from `target_files.check_target`.
        picture: The source of the levels.
        linear_levels: Every level, scene-linear, row 0 at the bottom.
        stored_levels: The same levels in the encoding of the picture.
        texture_format: A format of `prefilter.write_dds`; "auto" for floats or bytes like the
            picture's. Not for PNG.
        check: Called regularly.
        effort: See `prefilter.write_dds`.
        supercompression: See `prefilter.write_ktx2`; ignored for other files.
        quality: See `prefilter.write_ktx2`; ignored for formats other than "etc1s".
        metadata: See `prefilter.write_ktx2`; ignored for other files.
        threads: How many threads to use; 0 for all.

    Raises:
        ValueError: The values do not fit the format.
        OSError: A file cannot be written.
    """
    write_texture = _WRITERS.get(target.suffix.lower())
    if write_texture is None:
        return _stage_numbered(target, picture, linear_levels, stored_levels, check)
    chosen = _resolved_format(picture, texture_format)
    levels, encoding = _values(picture, linear_levels, stored_levels, chosen)
    alpha = "independent"
    if picture.alpha_is_coverage:
        alpha = "straight" if picture.alpha_is_straight else "premultiplied"
    elif chosen.alpha == "cut-out":
        levels = [level[..., :3] for level in levels]

    def go_on(_: float) -> bool:
        check()
        return True

    write = partial(
        write_texture,
        levels=levels,
        format=chosen.name,
        encoding=encoding,
        alpha=alpha,
        effort=effort,
        progress=go_on,
        threads=threads,
    )
    if metadata is not None and has_supercompression(target.name):
        write = partial(write, metadata=metadata)
    if chosen.is_shared and quality is not None:
        write = partial(write, quality=quality)
    elif has_supercompression(target.name) and not chosen.is_shared:
        write = partial(write, supercompression=supercompression)
    return [staging.stage_bytes(target, write)]


def _stage_numbered(
    target: Path,
    picture: Picture,
    linear_levels: Sequence[FloatArray],
    stored_levels: Sequence[FloatArray],
    check: Check,
) -> list[StagedFile]:
    is_srgb = not picture.is_data and (picture.is_float or picture.encoding is Encoding.SRGB)
    staged: list[StagedFile] = []
    try:
        for number, level in enumerate(linear_levels if picture.is_float else stored_levels):
            check()
            pixels = in_file_channels(_png_pixels(picture, level), is_gray=picture.is_gray)
            data = png.encoded(pixels, is_srgb=is_srgb)
            staged.append(staging.stage_data(numbered(target, number), data))
    except BaseException:
        for file in staged:
            file.discard()
        raise
    return staged


def _png_pixels(picture: Picture, level: FloatArray) -> np.ndarray[Any, Any]:
    """Returns 8-bit or 16-bit integers, with straight alpha."""
    if not picture.is_float:
        return _bytes(level)
    if picture.alpha_is_coverage and not picture.alpha_is_straight:
        level = unassociated(level)
    if not picture.is_data:
        level = prefilter.to_srgb(level)
    values = np.clip(np.nan_to_num(level, nan=0.0, posinf=1.0, neginf=0.0), 0, 1)
    return np.rint(values * 65535).astype(np.uint16)


def _label(texture_format: str) -> str:
    """Returns a format's label, such as "ASTC 6x6 HDR" for "astc-6x6-hdr"."""
    return re.sub(r"(\d)X(\d)", r"\1x\2", texture_format.upper().replace("-", " "))


def _resolved_format(picture: Picture, texture_format: str) -> TexelFormat:
    if texture_format == "auto":
        texture_format = "rgba16f" if picture.is_float else "rgba8"
    return prefilter.TEXEL_FORMATS[texture_format]


def _values(
    picture: Picture,
    linear_levels: Sequence[FloatArray],
    stored_levels: Sequence[FloatArray],
    chosen: TexelFormat,
) -> tuple[list[Any], str]:
    """Returns the levels to write, and the encoding that they have or will get."""
    if not (picture.is_float or chosen.is_float or picture.encoding is Encoding.OCIO):
        encoding = "srgb" if picture.encoding is Encoding.SRGB else "linear"
        return [_bytes(level) for level in stored_levels], encoding
    encoding = "linear" if picture.is_data or chosen.channels in _CHANNELS else "srgb"
    return list(linear_levels), encoding


def _bytes(level: FloatArray) -> np.ndarray[Any, Any]:
    # Rounded as Blender does, so that they equal the level images.
    return (np.clip(level, 0, 1) * np.float32(255) + np.float32(0.5)).astype(np.uint8)
