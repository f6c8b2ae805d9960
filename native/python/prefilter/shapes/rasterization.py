# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of vector shapes."""

from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    as_int,
    as_name,
    as_progress,
    as_size,
    set_options,
)
from .._border.arrays import FloatArray, as_threads
from .._border.names import RasterFilter
from ..images.pixel_filters import names_for
from .arguments import as_color
from .shape import Shape

RASTER_FILTERS: tuple[RasterFilter, ...] = names_for("raster")


def rasterize(
    shapes: Iterable[Shape],
    width: int,
    height: int,
    *,
    filter: RasterFilter = "box",
    method: str = "scanline",
    depth: int | None = None,
    background: Sequence[float] | None = None,
    overlap: str = "cover",
    dtype: npt.DTypeLike = np.float32,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FloatArray | npt.NDArray[np.uint8]:
    """The image of shapes, each pixel the mean around its center by a filter (chapter 2).

    The means are closed forms of the outlines as they are: no curve is made of lines, and no point
    is sampled. Lines and curves are exact to rounding; arcs of conics are to 1e-7 of the value.

    Args:
        shapes: What to draw, with as many channels each; see `Shape`.
        width: Pixels.
        height: Pixels.
        filter: "box" (what a pixel covers), "tent", "bspline2", "mitchell", "lanczos2", "lanczos3",
            "gaussian" (exp(-pi r^2)); or "radial2", "radial3", windowed jincs, of which frequencies
            of any direction are alike. All have an integral of 1; those from "mitchell" to
            "lanczos3", and the radial ones, have negative lobes, so values may leave the range of
            the colors.
        method: "scanline" (section 2.2), or "wavelet" (chapter 3), for the box filter and constant
            colors only. Both give the same image of closed contours. "wavelet" leaves open ones
            open, unless shapes cover each other: a gap changes values near it, and not the rows
            beside it. Of a shape that has one the winding numbers are drawn, whatever its fill
            rule.
        depth: Of "wavelet": where to end. The square of the smallest power of two that holds the
            image is halved so many times, and each pixel gets the mean over the cell that it is in.
            0 is one cell for all; None ends at pixels.
        background: What is behind the shapes, as many values as they have; None for 0.
        overlap: "cover": later shapes cover those before them, with four channels as far as alpha
            says. "add": the values of all shapes are summed, so that shapes that share an edge have
            no seam.
        dtype: float32, or uint8 for values from 0 to 1 as 0 to 255, rounded.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (height, width, channels), row 0 at the bottom. Where there are no shapes, as many channels
        as the background has, or one.

    Raises:
        ValueError: A name is none of those, shapes differ in their channels, a point is more than
            1e9 pixels away, a size is below 1, or the method has no such filter, color or depth.
        MemoryError: The image does not fit into memory.
        Cancelled: `progress` returned False.
    """
    options = set_options(_native.RasterOptions(), _CHECKS, locals(), rasterize.__kwdefaults__)
    try:
        drawn = list(shapes)
    except TypeError as error:
        raise ValueError(f"shapes: {shapes!r}; several of Shape are needed") from error
    for index, shape in enumerate(drawn):
        if not isinstance(shape, Shape):
            raise ValueError(f"shapes: item {index} is {type(shape).__name__}; Shape is needed")
    channels = drawn[0].channels if drawn else 1
    if background is not None and drawn and len(options.background) != channels:
        raise ValueError(
            f"background: {len(options.background)} values; {channels}, as the shapes have"
        )
    is_bytes = as_whether_bytes(dtype)
    parts = [(shape._outline, shape._fill_rule, shape._paint, shape._winds_once) for shape in drawn]
    image: FloatArray | npt.NDArray[np.uint8] = _native.rasterize(
        parts, options, is_bytes, as_progress(progress)
    )
    return image


def as_whether_bytes(dtype: npt.DTypeLike) -> bool:
    """Whether pixels are bytes: uint8 rather than float32."""
    if dtype is np.float32 or dtype is np.uint8:
        return dtype is np.uint8
    try:
        return {"float32": False, "uint8": True}[np.dtype(dtype).name]
    except (KeyError, TypeError) as error:
        raise ValueError(f"dtype: {dtype!r} is not one of float32, uint8") from error


def to_bytes(image: FloatArray) -> npt.NDArray[np.uint8]:
    """0 to 1 as 0 to 255, rounded."""
    levels: FloatArray = np.clip(image, 0.0, 1.0) * np.float32(255.0)
    return np.rint(levels).astype(np.uint8)


def _as_depth(depth: int | None) -> int:
    if depth is None:
        return -1
    needed = "a whole number of at least 0 is needed, or None"
    number = as_int("depth", depth, needed)
    if number < 0:
        raise ValueError(f"depth: {depth!r}; {needed}")
    return number


def _as_background(background: Sequence[float] | None) -> list[float]:
    return [] if background is None else list(as_color("background", background))


_CHECKS: dict[str, Check] = {
    "width": partial(as_size, "width"),
    "height": partial(as_size, "height"),
    "filter": partial(as_name, "filter"),
    "method": partial(as_name, "method"),
    "depth": _as_depth,
    "background": _as_background,
    "overlap": partial(as_name, "overlap"),
    "threads": as_threads,
}
