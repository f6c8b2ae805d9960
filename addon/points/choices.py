# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings of the operators on scans."""

from dataclasses import dataclass

from prefilter.options.options import Choice
from prefilter.options.points import (
    AGAINST,
    CLASSES,
    DIRECTIONS,
    ISOVALUES,
    POINTS,
    RESOLUTIONS,
    RETURNS,
    WAVELETS,
    ScanSettings,
)

from ..core.options import number, one_of, switch, text

__all__ = (
    "DIRECTIONS",
    "ISOVALUES",
    "POINTS",
    "RESOLUTIONS",
    "WAVELETS",
    "AlignSettings",
    "CropSettings",
    "ImportSettings",
    "OutlierSettings",
    "PaintSettings",
    "ScanSettings",
    "SubsampleSettings",
    "TrimSettings",
)


METHODS = {
    "poisson": Choice("Poisson Disk", "No two points are nearer to each other than the spacing"),
    "grid": Choice("Grid", "One point in each cell of a grid, the one nearest to their mean"),
}
KEEP = {
    "inside": Choice("Inside", "Keep the points in the box"),
    "outside": Choice("Outside", "Keep the points around the box"),
}


@dataclass(frozen=True)
class SubsampleSettings:
    """Settings of `prefilter.subsample_points`."""

    spacing: float = number(
        0.01,
        "Spacing",
        "How far apart the points that are kept should be, in world space",
        low=1e-6,
        subtype="DISTANCE",
        display={"soft_min": 0.001, "precision": 4, "step": 1},
    )
    method: str = one_of("poisson", "Method", "How points are chosen", METHODS)


@dataclass(frozen=True)
class OutlierSettings:
    """Settings of `prefilter.remove_outliers`."""

    neighbors: int = number(
        16,
        "Neighbors",
        "How many points around each count: more than twice as many as a clump has that should go",
        low=3,
        high=1000,
        display={"soft_max": 64},
    )
    factor: float = number(
        2.0,
        "Factor",
        "Remove points that are this many times as far from the points around them as these are "
        "from theirs. Lower values remove more",
        low=1.0,
        is_above=True,
        display={"soft_max": 5.0, "precision": 2, "step": 10},
    )


@dataclass(frozen=True)
class CropSettings:
    """Settings of `prefilter.crop_points`."""

    keep: str = one_of("inside", "Keep", "Which points are kept", KEEP)


@dataclass(frozen=True)
class AlignSettings:
    """Settings of `prefilter.align_scans`."""

    against: str = one_of("scans", "Align To", "What scans are aligned to", AGAINST)
    reach: float = number(
        0.0,
        "Reach",
        "How far apart surfaces may be that belong together, in world space. 0 takes a 20th of the "
        "size of all scans",
        low=0.0,
        subtype="DISTANCE",
        display={"precision": 4, "step": 1},
    )


@dataclass(frozen=True)
class PaintSettings:
    """Settings of `prefilter.paint_texture`."""

    size: int = number(
        2048, "Size", "Width and height of the texture, in texels", low=1, high=16384
    )
    smoothing: float = number(
        0.05,
        "Smoothing",
        "How much smoothness counts, compared with a point in each texel. More averages noise, "
        "less keeps detail",
        low=0.0001,
        high=1000.0,
        display={"soft_max": 1.0, "precision": 3, "step": 1},
    )


@dataclass(frozen=True)
class ImportSettings:
    """Settings of `prefilter.import_points`."""

    most_points: int = number(
        20_000_000,
        "Most Points",
        "A file with more points than this is thinned evenly while it is read: every second one, "
        "or third, and so on, is kept. 0 keeps all",
        low=0,
        high=2**31 - 1,
        display={"step": 1_000_000},
    )
    classes: str = text("", "Classes", CLASSES)
    returns: str = one_of(
        "all", "Returns", "Which echoes of each pulse of the scanner are kept", RETURNS
    )
    use_reconstruct: bool = switch(
        False,
        "Reconstruct Surface",
        "Make a surface of the points at once, with the settings of the panel Reconstruct Surface",
    )
    use_show_colors: bool = switch(
        True,
        "Show Colors",
        "Have 3D views in Solid mode show Material Preview if the points have colors: Solid mode "
        "has none for points",
    )


@dataclass(frozen=True)
class TrimSettings:
    """Settings of `prefilter.trim_reconstruction`."""

    limit: float = number(
        1.5,
        "Distance",
        "Cut the surface where it is farther from all points than this many times the distance "
        "between them there",
        low=0.0,
        display={"soft_min": 0.5, "soft_max": 20.0, "precision": 2, "step": 10},
    )
    hole: float = number(
        4.0,
        "Holes",
        "Keep what closes a hole if it is nowhere farther from all points than this many times "
        "the distance between them",
        low=0.0,
        display={"soft_max": 50.0, "precision": 1, "step": 50},
    )
    island: float = number(
        12.0,
        "Islands",
        "Remove separate parts that are as large as the area of fewer points than this, if "
        "anything was cut",
        low=0.0,
        display={"soft_max": 10000.0, "precision": 0, "step": 1000},
    )
