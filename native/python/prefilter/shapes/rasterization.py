# SPDX-License-Identifier: GPL-3.0-or-later

"""Rasterization of vector shapes."""

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
from ..images.filters import names_for
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
    """Rasterizes shapes: each pixel is a mean around its center, weighted by a filter (chapter 2).

    Means are closed forms of the outlines: no curve is flattened, and no point is sampled. Lines
    and Bezier curves are exact to rounding, conics to 1e-7 of the value.

    Args:
        shapes: Shapes with the same number of channels; see `Shape`.
        width: In pixels.
        height: In pixels.
        filter: "box" (area coverage), "tent", "bspline2", "mitchell", "lanczos2", "lanczos3",
            "gaussian" (exp(-pi r^2)); or "radial2", "radial3", windowed jincs with an isotropic
            response. All integrate to 1. From "mitchell" to "lanczos3", and for radial filters,
            lobes are negative, so values may exceed the range of the colors.
        method: "scanline" (section 2.2), or "wavelet" (chapter 3), which supports only the box
            filter and constant colors. Both give the same image of closed contours. "wavelet" does
            not close open ones, unless shapes cover each other: a gap changes values nearby only,
            but not whole rows. A shape with an open contour is drawn by winding numbers, whatever
            its fill rule.
        depth: Last level of "wavelet". The square of the smallest power of two that holds the image
            is halved this many times, and each pixel gets the mean of its cell. 0 is a single cell;
            None goes down to pixels.
        background: Values behind the shapes, one per channel; None for 0.
        overlap: "cover": later shapes cover earlier ones, with four channels according to alpha.
            "add": the values of all shapes are summed, so that shapes with a common edge have no
            seam.
        dtype: float32, or uint8 for values in [0, 1], scaled to 255 and rounded.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (height, width, channels), row 0 at the bottom. Without shapes, there are as many channels
        as in `background`, or one.

    Raises:
        ValueError: A name is unknown, shapes differ in their channels, a point is more than 1e9
            pixels away, a size is below 1, or the method does not support the filter, color or
            depth.
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
    """Returns whether pixels are uint8 rather than float32."""
    if dtype is np.float32 or dtype is np.uint8:
        return dtype is np.uint8
    try:
        return {"float32": False, "uint8": True}[np.dtype(dtype).name]
    except (KeyError, TypeError) as error:
        raise ValueError(f"dtype: {dtype!r} is not one of float32, uint8") from error


def to_bytes(image: FloatArray) -> npt.NDArray[np.uint8]:
    """Scales [0, 1] to 255 and rounds."""
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
