# SPDX-License-Identifier: GPL-3.0-or-later

"""Decisions based on nodes and pixels: the content of an image, and the format of its file."""

from dataclasses import dataclass
from pathlib import Path

from prefilter.workflows.files import target_files
from prefilter.workflows.textures import blocks
from prefilter.workflows.textures.blocks import is_gray

from ...bridge.images import Picture
from ..choices import TEXTURE_FORMATS
from .plan import Item

BY_CONTENT = ("auto", "blocks")
"""The settings that choose a texel format for each image by its content."""
_HEIGHTS = ("Bump", "Displacement", "Vector Displacement")
_FLOAT_LABELS = {".exr": "Half Float", ".png": "16-Bit"}
"""Precision of float images in files without a choice of formats; other files keep 32 bits."""


@dataclass(frozen=True)
class Decision:
    """The content as which an image is baked.

    Attributes:
        content: A key of `choices.CONTENTS` except "auto".
        note: Why it differs from the content that the nodes suggest; empty if it does not.
    """

    content: str
    note: str = ""


def decide_content(item: Item, picture: Picture) -> Decision:
    """Returns the content of an image, from its nodes and pixels."""
    if item.content != "cutout":
        return Decision(item.content)
    plain = "data" if picture.is_data else "color"
    has_alpha = picture.shape[2] == 4
    if item.tests_alpha:
        if has_alpha:
            return Decision("cutout")
        return Decision(plain, "is opaque, so its alpha test is left out")
    if not has_alpha and is_gray(picture):
        return Decision("cutout")
    return Decision(plain, "is tested by its color, but is no grayscale mask without alpha")


def texture_format(item: Item, picture: Picture, content: str, target: Path | None) -> str:
    """Returns the texel format that suits the content of an image.

    Args:
        item: The uses of the image in shaders.
        picture: Its pixels.
        content: A key of `choices.CONTENTS`.
        target: The file; None for none.

    Returns:
        A key of `choices.TEXTURE_FORMATS`; "auto" for a file without a choice of formats.
    """
    if target is None or not target_files.has_formats(target.name):
        return "auto"
    return blocks.suitable_format(
        picture,
        content,
        reads_alpha=picture.shape[2] == 4 and "alpha" in item.channels,
        is_height=any(use.startswith(_HEIGHTS) for use in item.uses),
        is_one_channel=item.channels == {"red"},
    )


def shown_format(picture: Picture, target: Path | None, chosen: str) -> str:
    """Returns the label of a file's texel format."""
    if target is None:
        return ""
    extension = target.suffix.lower()
    if target_files.has_formats(target.name):
        if chosen == "auto":
            chosen = "rgba16f" if picture.is_float else "rgba8"
        return TEXTURE_FORMATS[chosen].label
    if extension != ".exr" and not picture.is_float:
        return "8-Bit"
    return _FLOAT_LABELS.get(extension, "Float")
