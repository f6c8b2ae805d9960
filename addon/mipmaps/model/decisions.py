# SPDX-License-Identifier: GPL-3.0-or-later

"""What pixels add to what nodes say of an image: its content, and the format of its file."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...bridge.files import engines
from ...bridge.images import Encoding, Picture
from ..choices import CONTENTS, TEXTURE_FORMATS
from .plan import Item

_HEIGHTS = ("Bump", "Displacement", "Vector Displacement")
_OF_FILES = {".exr": "Half Float", ".png": "16-Bit"}
"""What float images get where there is no choice of formats; the others keep 32 bits."""


@dataclass(frozen=True)
class Decision:
    """How an image is baked.

    Attributes:
        content: A key of `choices.CONTENTS`, and not "auto".
        note: Why it is another content than the nodes say; empty if it is not.
    """

    content: str
    note: str = ""


def decided(item: Item, picture: Picture) -> Decision:
    """Returns the content of an image whose pixels are known."""
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
    """Returns the key of the texel format that suits what an image holds.

    Args:
        item: What shaders take of it.
        picture: Its pixels.
        content: A key of `choices.CONTENTS`.
        target: The file; None for none.

    Returns:
        A key of `choices.TEXTURE_FORMATS`; "auto" for a file that has no choice of formats.
    """
    if target is None or not engines.has_formats(target.name):
        return "auto"
    reads_alpha = picture.alpha_is_coverage or (picture.shape[2] == 4 and "alpha" in item.channels)
    is_precise = picture.is_float and (not picture.is_integer or _is_height(item))
    if content == "normal":
        return "bc7" if reads_alpha else "bc5"
    if is_precise:
        return "rgba16f" if reads_alpha or not _is_positive(picture) else "bc6h"
    has_no_srgb = picture.is_float or picture.encoding is Encoding.NONE
    is_data = has_no_srgb and content != "color" and not reads_alpha
    if is_data and (item.channels == {"red"} or is_gray(picture)):
        return "bc4"
    return "bc7"


def shown_format(picture: Picture, target: Path | None, chosen: str) -> str:
    """Returns how to call what a file holds."""
    if target is None:
        return ""
    extension = target.suffix.lower()
    if engines.has_formats(target.name):
        if chosen == "auto":
            chosen = "rgba16f" if picture.is_float else "rgba8"
        return TEXTURE_FORMATS[chosen].label
    if extension != ".exr" and not picture.is_float:
        return "8-Bit"
    return _OF_FILES.get(extension, "Float")


def shown_content(content: str) -> str:
    """Returns how to call a content."""
    return CONTENTS[content].label


def is_gray(picture: Picture) -> bool:
    """Tells whether red, green and blue are the same everywhere."""
    return bool((picture.texels[..., :1] == picture.texels[..., 1:3]).all())


def _is_height(item: Item) -> bool:
    return any(use.startswith(_HEIGHTS) for use in item.uses)


def _is_positive(picture: Picture) -> bool:
    return bool(np.nanmin(picture.texels[..., :3]) >= 0.0)
