# SPDX-License-Identifier: GPL-3.0-or-later

"""Options of the welcome, and the demonstrations."""

from dataclasses import dataclass
from typing import Any

from ..core.choices import Choice
from ..core.options import switch

DEMONSTRATIONS = {
    "mipmaps": Choice(
        "Bake and Compare",
        "Bake a painted stone, and show a small level of its texture by Box and by Prefilter "
        "beside the full texture",
    ),
    "solid": Choice("Make a Solid", "Make a closed solid of a mesh with holes and loose parts"),
    "surface": Choice("Make a Surface", "Make a closed surface of 20,000 scanned points"),
}

HOME = "prefilter_demonstration"
"""The custom property of a demonstration's scene with the name of the user's scene."""


def is_demonstration(scene: Any) -> bool:
    """Returns whether a scene belongs to a demonstration."""
    return scene is not None and HOME in scene


@dataclass(frozen=True)
class Preferences:
    """Its part of the preferences."""

    show_welcome: bool = switch(True, "Welcome", "Show the welcome in the tab of the 3D view")
