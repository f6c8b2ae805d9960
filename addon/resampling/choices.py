"""What a user may set for an image of another size."""

from dataclasses import dataclass

from ..core.choices import Choice
from ..core.options import number, one_of, switch, threads

SIZES = {
    "percent": Choice("Percent", "A share of the width and height of the image"),
    "pixels": Choice("Pixels", "A width and a height"),
}
FILTERS = {
    "lanczos3": Choice("Lanczos 3", "Sharp, with some ringing at edges"),
    "lanczos2": Choice("Lanczos 2", "Sharp, with less ringing and a little more aliasing"),
    "mitchell": Choice("Mitchell", "A compromise between blur, ringing and aliasing"),
    "least-squares": Choice(
        "Least Squares",
        "Closest to the image once it is enlarged again by interpolation, as renderers and viewers "
        "do. Sharp. For making images smaller",
    ),
    "radial3": Choice(
        "Radial 3", "Cuts off fine detail equally in all directions. Sharp, and slower"
    ),
    "radial2": Choice("Radial 2", "Like Radial 3, with less ringing"),
    "gaussian": Choice("Gaussian", "Soft, without ringing"),
    "bspline2": Choice("B-Spline 2", "Softer, without ringing"),
    "tent": Choice("Tent", "Soft, without ringing; interpolates linearly when enlarging"),
    "box": Choice("Box", "The average of the pixels; enlarged pixels stay squares"),
}
WRAPS = {
    "clamp": Choice("Clamp", "Extend edge pixels"),
    "repeat": Choice("Repeat", "The image tiles the plane"),
    "border": Choice("Border", "Black and transparent"),
}


@dataclass(frozen=True)
class ResizeSettings:
    """What `prefilter.resize` does, and the size."""

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
        low=1,
        high=1 << 20,
        subtype="PIXEL",
        display={"soft_max": 16384},
        flag_description="The new width in pixels; without --height, the height follows from it",
        metavar="PIXELS",
    )
    height: int = number(
        1024,
        "Height",
        "The new height in pixels",
        low=1,
        high=1 << 20,
        subtype="PIXEL",
        display={"soft_max": 16384},
        flag_description="The new height in pixels; without --width, the width follows from it",
        metavar="PIXELS",
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
        "Keep values between 0 and 1. Least Squares is solved within these limits, the results of "
        "other filters are clipped. Byte images always have them",
        flag_description="Keep values between 0 and 1; pictures of bytes always are",
    )
    wrap: str = one_of("clamp", "Wrap", "What lies outside the image", WRAPS, metavar="MODE")
    threads: int = threads()

    def new_size(self, width: int, height: int) -> tuple[int, int]:
        """Returns the new size of an image of this size."""
        if self.size == "percent":
            return _scaled(width, self.percent / 100.0), _scaled(height, self.percent / 100.0)
        if self.use_aspect:
            return self.width, _scaled(height, self.width / width)
        return self.width, self.height


def _scaled(size: int, factor: float) -> int:
    return max(1, round(size * factor))
