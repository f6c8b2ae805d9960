# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of SVG drawings."""

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

_READING_SHARE = 0.3


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
    """Renders a drawing, with its layers and images.

    Groups with opacity, blend mode, mask or filter are layers; clip paths are applied exactly.
    Patterns, markers and images are drawn: PNG, JPEG, GIF and WebP, decoded by Pillow or
    OpenImageIO, and SVG, embedded or in the file's folder. The drawing is fitted into the image by
    its preserveAspectRatio, and clipped at its page. Shapes between two layers are drawn as by
    `rasterize` with overlap="cover".

    Args:
        source: See `read_svg`.
        width: In pixels.
        height: In pixels.
        filter: Pixel filter of shapes; see `rasterize`. Images have a filter of their own.
        light: "srgb": colors are blended in their encoding for display, with opacities in steps of
            1/255, as in browsers. "linear": colors are blended in linear light.
        fonts: Font files and folders for text, in order of preference. Only these are used, so that
            the image is the same on every system. None: the system's fonts.
        dtype: float32, or uint8 for values in [0, 1], scaled to 255 and rounded.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        The image, (height, width, 4) with row 0 at the bottom: red, green and blue premultiplied by
        alpha, and alpha; encoded with light="srgb", scene-linear with "linear". And warnings about
        parts of the file that the image does not show, in the order of detection.

    Raises:
        ValueError: An argument is invalid, `read_svg` would refuse the source, or there are too
            many or too deeply nested layers; the message names the file.
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
    picture = SvgPicture(source, light, fonts, partial_progress(report, 0.0, _READING_SHARE))
    image = picture.drawn(
        *size,
        None,
        filter_name=filter,
        threads=count,
        progress=partial_progress(report, _READING_SHARE, 1.0),
    )
    return to_bytes(image) if is_bytes else image, picture.warnings


class SvgPicture:
    """A drawing to render several times. See `rasterize_svg` for arguments."""

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
        """Width of the page, in pixels."""
        return self._drawing.page.width

    @property
    def height(self) -> float:
        """Height of the page, in pixels."""
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
        """Renders the drawing.

        Args:
            width: In pixels.
            height: In pixels.
            place: Scale of the page, and x and y of its lower left corner. None for a page that
                fills the image.
            filter_name: See `rasterize`.
            threads: See `rasterize`.
            progress: See `rasterize`.
        """
        from ._svg.draw.compositing import Compositor
        from ._svg.draw.opening import as_value_errors

        drawing = self._drawing
        if place is None:
            to_pixels, around = drawing.placement(float(width), float(height))
        else:
            scale, x, y = place
            to_pixels, around = drawing.placement_at(scale, x, y)
        compositor = Compositor(filter_name, threads, progress_reporter(progress))
        with as_value_errors(self._name):
            return compositor.draw(drawing, to_pixels, (width, height), around)


def partial_progress(
    progress: ProgressCallback | None, begin: float, end: float
) -> ProgressCallback | None:
    """Maps progress to a part of the work."""
    if progress is None:
        return None
    return lambda share: progress(begin + (end - begin) * share)
