# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of bake settings against the image, and the roughness that belongs to a normal map."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import prefilter

from ...options.textures import Settings
from ..files import target_files
from ..picture import Picture, scene_linear
from ..wording import Sentence
from . import blocks, contents
from .source import reads_encoded


@dataclass(frozen=True)
class RoughnessOutput:
    """The roughness of a normal map.

    Attributes:
        roughness: The roughness image; None for none.
        target: Its file; None for none.
    """

    roughness: contents.Roughness | None = None
    target: Path | None = None


def roughness_of(
    settings: Settings,
    normal_map: Picture,
    content: str,
    targets: Sequence[Path],
    read: Callable[[], Picture],
    texture_format: str = "",
) -> RoughnessOutput:
    """Returns the roughness of a normal map, after checking the settings.

    Args:
        settings: The settings of the bake.
        normal_map: The image that is baked.
        content: The content of that image.
        targets: The files of that image.
        read: Reads the roughness image.
        texture_format: The format of the roughness file; empty for `roughness_format`.

    Raises:
        ValueError: The settings contradict one another, or the images do not fit.
        OSError: The file of the roughness cannot be written.
    """
    if not settings.roughness:
        if settings.roughness_filepath:
            raise ValueError(Sentence("Roughness File: choose a Roughness image too"))
        return RoughnessOutput()
    if content != "normal":
        if settings.content == "auto":
            return RoughnessOutput()
        raise ValueError(
            f"Roughness: '{settings.roughness}' needs a normal map, and the content is '{content}'"
        )
    if not settings.use_images and not settings.roughness_filepath:
        raise ValueError(
            Sentence("nothing to write the roughness to: choose level images or a Roughness File")
        )
    target = None
    if settings.roughness_filepath:
        target = target_files.check_target(settings.roughness_filepath)
        if target in targets:
            raise ValueError(f"Roughness File: '{target}' is the file of the normal map")
    picture = read()
    contents.check_roughness(normal_map, picture)
    chosen = texture_format or roughness_format(settings, picture)
    linear = scene_linear(picture)
    return RoughnessOutput(
        contents.Roughness(picture, linear, settings.roughness_channel, chosen), target
    )


def roughness_format(settings: Settings, picture: Picture) -> str:
    """Returns the format of the roughness file: the normal map's, unless that lacks channels."""
    chosen = prefilter.TEXEL_FORMATS.get(settings.texture_format)
    if chosen is None or chosen.channels > 2:
        return settings.texture_format
    if settings.roughness_channel == "all":
        return "bc4" if chosen.is_in_dds else "eac-r11"
    if chosen.is_in_dds:
        return "bc7"
    return "etc2-rgba" if picture.stored.shape[2] == 4 else "etc2-rgb"


def usage_warnings(
    settings: Settings,
    picture: Picture,
    content: str,
    targets: Sequence[Path],
    rough: RoughnessOutput,
    *,
    is_encoded: bool,
) -> list[str]:
    """Returns warnings about settings that do not fit the image, or one another."""
    warnings = []
    if content == "normal" and is_encoded:
        warnings.append(
            f"image '{picture.name}' has the color space {picture.colorspace}; "
            "shaders read normals correctly only in Non-Color"
        )
    if settings.reader != "linear":
        warnings.extend(_reader_warnings(picture, targets))
        if settings.lookups in {"one-lookup", "anisotropic", "views"} and reads_encoded(picture):
            warnings.append(
                "Lookups: readers of encoded texels are always supersampled, so "
                f"'{picture.name}' is baked for that"
            )
    if settings.roughness and rough.roughness is None:
        warnings.append(
            f"Roughness: '{settings.roughness}' is not used, because '{picture.name}' "
            "is not a normal map"
        )
    return warnings


def suitable_blocks(pictures: Sequence[Picture], content: str) -> str:
    """Returns the format that suits an image, or all tiles of one."""
    return blocks.common_format(
        blocks.suitable_format(picture, content, reads_alpha=picture.shape[2] == 4)
        for picture in pictures
    )


def _reader_warnings(picture: Picture, targets: Sequence[Path]) -> list[str]:
    """Returns warnings if an output cannot be read as encoded texels."""
    if not reads_encoded(picture):
        return [
            f"Reader: '{picture.name}' is not an 8-bit sRGB image, so it is read as linear light"
        ]
    return [
        f"Reader: '{target}' is read as linear light, but its levels are for encoded texels"
        for target in targets
        if target.suffix.lower() in {".exr", ".dds", ".ktx2"}
    ]
