# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of whole SVG drawings."""

import os
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from .._border.arguments import ProgressCallback, as_name, as_one_of, as_progress, as_size
from .._border.arrays import FloatArray, as_threads
from .._border.names import RasterFilter
from ._svg.model.warnings import SvgWarning
from .rasterization import RASTER_FILTERS, as_whether_bytes, to_bytes
from .svg import progress_reporter

_READ = 0.3


def rasterize_svg(
    source: str | os.PathLike[str] | bytes,
    width: int,
    height: int,
    *,
    filter: RasterFilter = "box",
    light: str = "srgb",
    fonts: Iterable[str | os.PathLike[str]] | None = None,
    dtype: npt.DTypeLike = np.float32,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> tuple[FloatArray | npt.NDArray[np.uint8], tuple[SvgWarning, ...]]:
    """The image of a drawing: its shapes, and the layers that they make.

    Groups with an opacity, a blend mode, a mask or a filter are layers; shapes are cut off at clip
    paths exactly. Patterns, markers and images are drawn: PNG, JPEG, GIF and WebP, read by Pillow
    or by OpenImageIO, and SVG, embedded in the file or in its folder. The drawing fills the image
    as its preserveAspectRatio says, and is cut off at its page. Shapes between two layers are drawn
    as by `rasterize` with overlap="cover".

    Args:
        source: As of `read_svg`.
        width: Pixels.
        height: Pixels.
        filter: As of `rasterize`. Images have a filter of their own.
        light: "srgb": colors are mixed as they are encoded for display, as in browsers, opacities
            in steps of a 255th. "linear": as light is.
        fonts: Files and folders of fonts for text, the best first: only these, so that the image
            is the same on every system. None: the fonts of the system.
        dtype: float32, or uint8 for values from 0 to 1 as 0 to 255, rounded.
        progress: Called with the fraction done; False stops.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        The image, (height, width, 4) with row 0 at the bottom: red, green and blue multiplied by
        alpha, and alpha; encoded with light="srgb", scene-linear with "linear". And what was found
        in the file and is not in the image, in the order in which it was found.

    Raises:
        ValueError: An argument is not as said, or `read_svg` would refuse the source, or its layers
            are too many or too deep; the message names the file.
        OSError: The file cannot be read.
        MemoryError: The image does not fit into memory.
        Cancelled: `progress` returned False.
    """
    as_one_of("light", as_name("light", light), ("linear", "srgb"))
    as_one_of("filter", as_name("filter", filter), RASTER_FILTERS)
    size = as_size("width", width), as_size("height", height)
    count = as_threads(threads)
    is_bytes = as_whether_bytes(dtype)
    report = as_progress(progress)
    picture = SvgPicture(source, light, fonts, part_of(report, 0.0, _READ))
    image = picture.drawn(
        *size, None, filter_name=filter, threads=count, progress=part_of(report, _READ, 1.0)
    )
    return to_bytes(image) if is_bytes else image, picture.warnings


class SvgPicture:
    """A drawing that was read to be drawn. Arguments are as of `rasterize_svg`."""

    def __init__(
        self,
        source: str | os.PathLike[str] | bytes,
        light: str,
        fonts: Iterable[str | os.PathLike[str]] | None,
        progress: ProgressCallback | None,
    ) -> None:
        from ._svg.draw.opening import open_drawing
        from ._svg.model.gradients import Colors

        colors = Colors(light == "linear", is_stepped=light == "srgb")
        self._name, self._drawing, warnings = open_drawing(
            source, colors=colors, reads_files=True, report=progress_reporter(progress), fonts=fonts
        )
        self.warnings = warnings.all()

    @property
    def width(self) -> float:
        """Of its page, in pixels."""
        return self._drawing.page.width

    @property
    def height(self) -> float:
        """Likewise."""
        return self._drawing.page.height

    def drawn(
        self,
        width: int,
        height: int,
        place: tuple[float, float, float] | None,
        *,
        filter_name: str,
        threads: int,
        progress: ProgressCallback | None,
    ) -> FloatArray:
        """The image.

        Args:
            width: Pixels.
            height: Pixels.
            place: How many pixels a pixel of the page becomes, and where its lower left corner is.
                None for a page that fills the image.
            filter_name: As of `rasterize`.
            threads: As there.
            progress: As there.
        """
        from ._svg.draw.compositing import Compositor
        from ._svg.draw.opening import as_value_errors

        drawing = self._drawing
        if place is None:
            to_pixels, around = drawing.placement(float(width), float(height))
        else:
            scale, x, y = place
            to_pixels, around = drawing.placed(scale, x, y)
        compositor = Compositor(filter_name, threads, progress_reporter(progress))
        with as_value_errors(self._name):
            return compositor.draw(drawing, to_pixels, (width, height), around)


def part_of(progress: ProgressCallback | None, begin: float, end: float) -> ProgressCallback | None:
    """Tells of a part of the work."""
    if progress is None:
        return None
    return lambda share: progress(begin + (end - begin) * share)
