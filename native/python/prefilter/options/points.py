# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings for reconstructing surfaces from points."""

from dataclasses import dataclass

import prefilter

from .options import Choice, number, numbers, one_of, switch, text, threads

RESOLUTIONS = {
    "auto": Choice(
        "Automatic",
        "As fine as the points carry: cells about as wide as the points are apart on most of the "
        "surface",
    ),
    "depth": Choice("Depth", "Halve the cube around the points this many times"),
    "size": Choice("Voxel Size", "Cells of at most this size, in the units of the world"),
}
WAVELETS = {
    "haar": Choice("Haar", "Best for noise, several scans and holes, and fastest"),
    "d4": Choice(
        "D4",
        "A little closer to points that are exact. Takes up to twice as long; with noise, or scans "
        "that are a little off, the surface folds",
    ),
}
ISOVALUES = {
    "auto": Choice("Automatic", "Chosen by Prefilter: the mean of the values at the points"),
    "half": Choice("One Half", "Where cells are half full"),
    "mean": Choice("Mean at Points", "The mean of the values at the points"),
    "custom": Choice("Custom", "A value of your own"),
}
DIRECTIONS = {
    "auto": Choice(
        "Automatic",
        "As Given where points have normals, Viewpoint where the scanner's position is known or is "
        "the origin, Up for .las and .laz files and for heights such as a terrain, else Outward",
    ),
    "up": Choice("Up", "Toward the sky, as for a terrain scanned from the air"),
    "viewpoint": Choice(
        "Viewpoint", "Toward the scanner. Where its position is not known, it is the scan's origin"
    ),
    "outward": Choice(
        "Outward",
        "Out of a closed shape: all are flipped if most of them point inward",
    ),
    "given": Choice("As Given", "As the points have them; points without normals are refused"),
}
POINTS = {
    "keep": Choice("Keep", "The points stay visible"),
    "hide": Choice("Hide", "The points are hidden, in renders too"),
    "delete": Choice("Delete", "The points are deleted"),
}
RETURNS = {
    "all": Choice("All", "All of them"),
    "first": Choice("First", "The first of each pulse: roofs and the tops of trees"),
    "last": Choice("Last", "The last of each pulse: more of the ground below trees"),
    "only": Choice("Only", "Those of pulses that have no other"),
}
AGAINST = {
    "scans": Choice("Scans", "To the points of the others"),
    "surface": Choice(
        "Surface", "Then also to a surface of all, twice: closer, as it averages their noise"
    ),
}
CLASSES = (
    "Numbers of the classes that are kept, such as 2 for the ground in LAS files, separated by "
    "commas. Empty keeps all"
)


@dataclass(frozen=True)
class ScanSettings:
    """Settings of `prefilter.reconstruct`."""

    resolution: str = one_of(
        "auto", "Resolution", "How to specify the size of the cells", RESOLUTIONS, flag=""
    )
    depth: int = number(
        9,
        "Depth",
        "Octree depth: 9 gives 512 cells per axis. Each step quadruples the triangles, as far as "
        "there are enough points",
        low=1,
        high=prefilter.MAX_DEPTH,
        display={"soft_max": 11},
        flag_description="octree depth, instead of one that the points carry: 9 gives 512 cells "
        "per axis. Each step quadruples the triangles, as far as there are enough points",
        metavar="N",
    )
    voxel_size: float = number(
        0.01,
        "Voxel Size",
        "Largest side of a cell in world space: the cube around the points is halved until "
        "cells are no larger",
        low=1e-6,
        subtype="DISTANCE",
        display={"soft_min": 0.001, "precision": 4, "step": 1},
        flag_description="largest side of a cell, instead of a depth",
        metavar="LENGTH",
    )
    wavelet: str = one_of(
        "haar", "Wavelet", "Basis in which the surface is computed", WAVELETS, metavar="NAME"
    )
    use_smooth: bool = switch(
        True,
        "Smoothing",
        "Smooth the values inside and outside before the surface is extracted: fewer bumps "
        "from noise",
    )
    use_fit: bool = switch(
        True,
        "Fit to Points",
        "Move the vertices onto planes through the nearest points: details finer than a cell",
    )
    use_watertight: bool = switch(
        False,
        "Watertight",
        "Close the surface everywhere. Otherwise it is open where the scan is: parts far from "
        "all points, compared with the distance between these, are cut, and small holes are "
        "closed",
    )
    trim: float = number(
        0.0,
        "Trim",
        "Instead of that, remove surface that is farther from every point than this many cells, "
        "however far points are from one another. 0 leaves it to Watertight",
        low=0.0,
        display={"soft_max": 20.0, "precision": 1, "step": 50},
        metavar="CELLS",
    )
    adaptivity: float = number(
        0.0,
        "Adaptivity",
        "Make triangles larger where the surface is flat or gently curved, as long as it stays "
        "within this distance, in cells. Colors between vertices that stay are lost",
        low=0.0,
        high=10.0,
        display={"soft_max": 1.0, "precision": 2, "step": 1},
        metavar="CELLS",
    )
    direction: str = one_of(
        "auto",
        "Normals",
        "Where the normals of the points point: the side of the surface that is seen",
        DIRECTIONS,
        metavar="NAME",
    )
    isovalue: str = one_of(
        "auto",
        "Iso-Value",
        "Value at which the surface lies, between 0 outside and 1 inside",
        ISOVALUES,
        metavar="NAME",
    )
    custom_isovalue: float = number(
        0.5,
        "Value",
        "Higher values shrink the surface, lower ones grow it",
        low=0.0,
        high=1.0,
        is_above=True,
        flag_description="The value at the surface, instead of --isovalue",
        metavar="VALUE",
    )
    points: str = one_of(
        "hide", "Points", "What to do with the objects that contain the points", POINTS, flag=""
    )
    use_smooth_shading: bool = switch(
        True,
        "Smooth Shading",
        "Shade the result smooth",
    )
    # Which points of files are read: for commands only, as objects are already imported.
    classes: str = text("", "", CLASSES, metavar="N[,N]")
    returns: str = one_of(
        "all", "", "Which echoes of each pulse of the scanner are kept", RETURNS, metavar="NAME"
    )
    box: tuple[float, ...] = numbers(
        (0.0,) * 6,
        "",
        "Keep the points in a box, given by its lowest x, y and z and its highest",
        metavar="NUMBER",
    )
    use_align: bool = switch(False, "", "Move the files onto the first of them, a little")
    align_to: str = one_of("scans", "", "What files are aligned to", AGAINST, metavar="NAME")
    memory_limit: int = number(
        0,
        "Memory Limit",
        "Use at most this many MiB beside the points, and temporary files for the rest; "
        "0 sets no limit",
        low=0,
        display={"soft_max": 65536},
        metavar="MiB",
        preference="memory_limit",
    )
    threads: int = threads()
