# SPDX-License-Identifier: GPL-3.0-or-later

"""Options of images of shapes."""

from dataclasses import dataclass

from prefilter.options.shapes import (
    ALPHAS,
    BACKGROUNDS,
    COLORS,
    FILTERS,
    LARGEST_SIDE,
    LIGHTS,
    OVERLAPS,
    PIXEL_TYPES,
    RESOLUTIONS,
    SOURCES,
    VIEWS,
    RasterizeSettings,
)

from ..core.choices import Choice
from ..core.options import number, one_of, switch

__all__ = (
    "ALPHAS",
    "BACKGROUNDS",
    "COLORS",
    "DECALS",
    "FILTERS",
    "LARGEST_SIDE",
    "LIGHTS",
    "OVERLAPS",
    "PIXEL_TYPES",
    "RESOLUTIONS",
    "SOURCES",
    "VIEWS",
    "DecalSettings",
    "RasterizeSettings",
)

DECALS = {
    "plane": Choice(
        "Plane", "A new plane where the shapes are, with a material that shows the image"
    ),
    "material": Choice(
        "Material", "Over the base color of the active object's material, by its UV map"
    ),
}


@dataclass(frozen=True)
class DecalSettings:
    """Options of `prefilter.use_as_decal`."""

    target: str = one_of("plane", "Put on", "Where the image goes", DECALS, flag="")
    use_hide: bool = switch(
        True,
        "Hide Source",
        "Hide the curves and texts that the image shows, in the place of which the plane is",
        flag="",
    )
    offset: float = number(
        0.0,
        "Offset",
        "How far in front of the shapes the plane is",
        subtype="DISTANCE",
        display={"step": 1, "precision": 3},
        flag="",
    )
