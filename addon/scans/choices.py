# SPDX-License-Identifier: GPL-3.0-or-later

"""What a user may set for the surface of points, and for files of them."""

from dataclasses import dataclass

from prefilter._options.scans import (
    DIRECTIONS,
    ISOVALUES,
    POINTS,
    RESOLUTIONS,
    WAVELETS,
    ScanSettings,
)

from ..core.options import number, switch

__all__ = (
    "DIRECTIONS",
    "EXTENSIONS",
    "ISOVALUES",
    "POINTS",
    "RESOLUTIONS",
    "WAVELETS",
    "ImportSettings",
    "ScanSettings",
    "TrimSettings",
)

EXTENSIONS = (
    *(".las", ".laz", ".e57", ".pcd", ".ply"),
    *(".xyz", ".xyzn", ".pts", ".ptx", ".asc", ".txt", ".csv"),
)
"""Of files of points: `prefilter.POINT_EXTENSIONS`, which takes long to import."""


@dataclass(frozen=True)
class ImportSettings:
    """What is read of files of points."""

    most_points: int = number(
        20_000_000,
        "Most Points",
        "A file with more points than this is thinned evenly while it is read: every second one, "
        "or third, and so on, is kept. 0 keeps all",
        low=0,
        high=2**31 - 1,
        display={"step": 1_000_000},
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
    """How much of a reconstructed surface is cut afterward."""

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
        64.0,
        "Islands",
        "Remove separate parts that are as large as the area of fewer points than this, if "
        "anything was cut",
        low=0.0,
        display={"soft_max": 10000.0, "precision": 0, "step": 1000},
    )
