# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings for resizing and resampling images."""

import math
from dataclasses import dataclass
from typing import Any

from .filters import filters_for
from .options import Choice, number, numbers, one_of, switch, text, threads

SIZES = {
    "percent": Choice("Percent", "A share of the width and height of the image"),
    "pixels": Choice("Pixels", "A width and a height"),
}
FILTERS = filters_for(
    "resize",
    {
        "lanczos3": "Sharp, with some ringing at edges",
        "lanczos2": "Sharp, with less ringing and a little more aliasing",
        "mitchell": "A compromise between blur, ringing and aliasing",
        "least-squares": "Closest to the image when the result is enlarged again by "
        "interpolation, as renderers and viewers do. Sharp. For reducing images",
        "radial3": "Cuts off fine detail equally in all directions. Sharp, and slower",
        "radial2": "Like Radial 3, with less ringing",
        "gaussian": "Soft, without ringing",
        "bspline2": "Softer, without ringing",
        "tent": "Soft, without ringing; interpolates linearly when enlarging",
        "box": "The average of the pixels; enlarged pixels stay squares",
    },
)
RINGING = {
    "auto": Choice("Automatic", "Limited for Least Squares, allowed for the other filters"),
    "limit": Choice("Limited", "No value lies beyond those of the old pixels around"),
    "allow": Choice("Allowed", "Values go as far as the filter takes them"),
}
WRAPS = {
    "clamp": Choice("Clamp", "Extend edge pixels"),
    "repeat": Choice("Repeat", "The image tiles the plane"),
    "border": Choice("Border", "Black and transparent"),
}
WARPS = {
    "affine": Choice("Scale and Rotate", "Scale and rotate the image about its center"),
    "corners": Choice("Corner Pins", "Put the corners of the image at four places of the result"),
    "rectify": Choice(
        "Rectify",
        "Put four places of the image, such as the corners of a window, at the corners "
        "of the result",
    ),
}
SUFFIXES = {"affine": "transformed", "corners": "pinned", "rectify": "rectified"}
"""Suffix of a result's name, by its warp."""
RESULT_SIZES = {
    "fit": Choice("Fit", "Just large enough for the whole result"),
    "image": Choice("Image", "As large as the image"),
    "pixels": Choice("Pixels", "A width and a height"),
}
PROPORTIONS = {
    "perspective": Choice(
        "Perspective",
        "As a camera with square pixels saw it that looked through the middle of the image. For "
        "photographs that were not cropped",
    ),
    "sides": Choice("Sides", "As the longest sides between the corners"),
    "given": Choice("Given", "A number"),
}
TABLE_FILTERS = filters_for(
    "sampling", {name: choice.description for name, choice in FILTERS.items()}
)
METHODS = {
    "exact": Choice("Exact", "Every pixel under the filter. The best, and the slowest"),
    "8": Choice("8 Texels", "8 texels of the mipmap per pixel, weighted by a sampling table"),
    "6": Choice("6 Texels", "6 texels per pixel, weighted by a sampling table"),
    "4": Choice("4 Texels", "4 texels per pixel, weighted by a sampling table"),
    "table": Choice("Table File", "Texels and weights from a table saved by Make Sampling Table"),
    "trilinear": Choice(
        "Trilinear", "8 texels of the mipmap, interpolated as on graphics cards, for comparison"
    ),
}
CORNERS = ("lower_left", "lower_right", "upper_right", "upper_left")
"""The corners' options, in order around the image."""
LONGEST_SIDE = 1 << 20
"""The greatest width and height of an image, in pixels."""

_SIDE: dict[str, Any] = {
    "low": 1,
    "high": LONGEST_SIDE,
    "subtype": "PIXEL",
    "display": {"soft_max": 16384},
    "metavar": "PIXELS",
}


def _factor(label: str, description: str) -> Any:
    return number(
        1.0,
        label,
        description,
        low=-1000.0,
        high=1000.0,
        display={"soft_min": 0.01, "soft_max": 8.0, "precision": 3, "step": 1},
        metavar="FACTOR",
    )


def _offset(label: str, description: str) -> Any:
    return number(
        0.0,
        label,
        description,
        low=-1e6,
        high=1e6,
        subtype="PIXEL",
        display={"soft_min": -4096.0, "soft_max": 4096.0},
        metavar="PIXELS",
    )


def _corner(default: tuple[float, float], label: str) -> Any:
    return numbers(
        default,
        label,
        "Position of this corner, as shares of the width and height from the lower left",
        low=-1e6,
        high=1e6,
        display={"soft_min": -1.0, "soft_max": 2.0, "precision": 3, "step": 1},
        flag="",
    )


@dataclass(frozen=True)
class ResizeSettings:
    """Settings of `prefilter.resize`, including the new size."""

    size: str = one_of("percent", "Size", "How to specify the new size", SIZES, flag="")
    percent: float = number(
        50.0,
        "Percent",
        "The new size in percent of the old one",
        low=0.0,
        is_above=True,
        subtype="PERCENTAGE",
        display={"soft_min": 1.0, "soft_max": 400.0, "precision": 1},
        metavar="PERCENT",
    )
    width: int = number(
        1024,
        "Width",
        "The new width in pixels",
        **_SIDE,
        flag_description="The new width in pixels; without --height, the height follows from it",
    )
    height: int = number(
        1024,
        "Height",
        "The new height in pixels",
        **_SIDE,
        flag_description="The new height in pixels; without --width, the width follows from it",
    )
    use_aspect: bool = switch(
        True,
        "Keep Aspect Ratio",
        "The height follows from the width",
        flag="",
    )
    filter: str = one_of(
        "lanczos3",
        "Filter",
        "How the new pixels are computed from the old ones",
        FILTERS,
        metavar="FILTER",
    )
    use_constrained: bool = switch(
        False,
        "Limit Values",
        "Keep values between 0 and 1. Least Squares is solved within these limits, the "
        "results of other filters are clipped. Byte images are always limited",
        flag_description="Keep values between 0 and 1; byte pictures are always limited",
    )
    ringing: str = one_of(
        "auto",
        "Ringing",
        "Whether values may overshoot at edges: dark and bright lines there, and values below 0 "
        "around a bright sun",
        RINGING,
        metavar="MODE",
    )
    wrap: str = one_of("clamp", "Wrap", "The texels outside the image", WRAPS, metavar="MODE")
    threads: int = threads()

    def new_size(self, width: int, height: int) -> tuple[int, int]:
        """Returns the new size of an image of the given size."""
        if self.size == "percent":
            return _scaled(width, self.percent / 100.0), _scaled(height, self.percent / 100.0)
        if self.use_aspect:
            return self.width, _scaled(height, self.width / width)
        return self.width, self.height


@dataclass(frozen=True)
class ResampleSettings:
    """Settings of `prefilter.resample`, including the transform."""

    warp: str = one_of("affine", "Warp", "How to transform the image", WARPS, flag="")
    scale_x: float = _factor("Scale X", "Scale factor along x; negative values mirror")
    scale_y: float = _factor("Scale Y", "Scale factor along y; negative values mirror")
    rotation: float = number(
        0.0,
        "Rotation",
        "The angle to turn by, counterclockwise",
        low=-2 * math.pi,
        high=2 * math.pi,
        subtype="ANGLE",
        flag="--rotate",
        metavar="DEGREES",
    )
    offset_x: float = _offset("Offset X", "How far to move to the right, in pixels of the result")
    offset_y: float = _offset("Offset Y", "How far to move upwards, in pixels of the result")
    lower_left: tuple[float, float] = _corner((0.0, 0.0), "Lower Left")
    lower_right: tuple[float, float] = _corner((1.0, 0.0), "Lower Right")
    upper_right: tuple[float, float] = _corner((1.0, 1.0), "Upper Right")
    upper_left: tuple[float, float] = _corner((0.0, 1.0), "Upper Left")
    use_pixels: bool = switch(
        False, "", "Corners are in pixels, from the lower left, instead of in shares of the size"
    )
    size: str = one_of("fit", "Size", "Size of the result", RESULT_SIZES, metavar="SIZE")
    width: int = number(1024, "Width", "The width of the result in pixels", **_SIDE)
    height: int = number(1024, "Height", "The height of the result in pixels", **_SIDE)
    proportions: str = one_of(
        "perspective",
        "Proportions",
        "Width by height of the rectified region, where the size is fitted",
        PROPORTIONS,
        metavar="MODE",
    )
    aspect: float = number(
        4 / 3,
        "Aspect Ratio",
        "Width by height of the rectified region, such as 4/3",
        low=0.0,
        high=1e6,
        is_above=True,
        display={"soft_min": 0.1, "soft_max": 10.0, "precision": 4, "step": 1},
        metavar="RATIO",
        flag_description="width by height of the rectified region; sets --proportions given",
    )
    filter: str = one_of(
        "lanczos2",
        "Filter",
        "How the new pixels are computed from the old ones",
        TABLE_FILTERS,
        metavar="FILTER",
    )
    method: str = one_of(
        "exact",
        "Method",
        "How the filter is evaluated",
        METHODS,
        metavar="METHOD",
    )
    table: str = text(
        "",
        "Table",
        "Sampling table for the method Table File. Its filter is used",
        subtype="FILE_PATH",
        metavar="FILE",
    )
    max_probes: int = number(
        1,
        "Max Probes",
        "Maximum number of samples in a row per pixel, where the image is squeezed more in "
        "one direction than in the other, as toward a horizon. 1 blurs there, more are "
        "sharper. Only for Gaussian",
        low=1,
        high=256,
        display={"soft_max": 32},
        metavar="N",
    )
    wrap: str = one_of("border", "Wrap", "The texels outside the image", WRAPS, metavar="MODE")
    threads: int = threads()


def _scaled(size: int, factor: float) -> int:
    return max(1, round(size * factor))
