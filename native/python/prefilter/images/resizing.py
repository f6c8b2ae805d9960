# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing of images (chapter 1)."""

from functools import partial
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    Wrap,
    as_name,
    as_progress,
    as_size,
    as_wrap,
    is_srgb,
    set_options,
)
from .._border.arrays import as_image, as_texels, as_threads, in_form_of
from .._border.names import Encoding, ResizeFilter, Ringing
from .color import as_light, as_words
from .filters import names_for

RESIZE_FILTERS: tuple[ResizeFilter, ...] = names_for("resize")
"""All filters of `resize`."""

_CHECKS: dict[str, Check] = {
    "filter": partial(as_name, "filter"),
    "constrained": bool,
    "ringing": partial(as_name, "ringing"),
    "wrap": as_wrap,
    "premultiplied": bool,
    "threads": as_threads,
}


@overload
def resize(
    image: npt.ArrayLike,
    width: int,
    height: int,
    *,
    filter: ResizeFilter = "lanczos3",
    constrained: bool = False,
    ringing: Ringing = "auto",
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    encoding: None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float32]: ...
@overload
def resize(
    image: npt.NDArray[np.uint8],
    width: int,
    height: int,
    *,
    filter: ResizeFilter = "lanczos3",
    constrained: bool = False,
    ringing: Ringing = "auto",
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    encoding: Encoding,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.uint8]: ...
@overload
def resize(
    image: npt.NDArray[np.uint16],
    width: int,
    height: int,
    *,
    filter: ResizeFilter = "lanczos3",
    constrained: bool = False,
    ringing: Ringing = "auto",
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    encoding: Encoding,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.uint16]: ...
@overload
def resize(
    image: npt.ArrayLike,
    width: int,
    height: int,
    *,
    filter: ResizeFilter = "lanczos3",
    constrained: bool = False,
    ringing: Ringing = "auto",
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    encoding: Encoding,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[Any]: ...
@overload
def resize(
    image: npt.ArrayLike,
    width: int,
    height: int,
    *,
    filter: ResizeFilter = "lanczos3",
    constrained: bool = False,
    ringing: Ringing = "auto",
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    encoding: Encoding | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[Any]: ...
def resize(
    image: npt.ArrayLike,
    width: int,
    height: int,
    *,
    filter: ResizeFilter = "lanczos3",
    constrained: bool = False,
    ringing: Ringing = "auto",
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    encoding: Encoding | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[Any]:
    """The image resized to a larger or smaller number of pixels.

    Kernels ("box", "tent", "bspline2", "mitchell", "lanczos2", "lanczos3", "gaussian") filter along
    x and along y. Along each axis their unit is the larger one of old and new pixels, and an axis
    of unchanged size is not filtered. "box" is the mean of the old pixels, as squares, over the
    square of the new one; when enlarging, pixels stay squares.

    "radial2" and "radial3" weigh pixels by their distance r with jinc(r) sinc(r / radius), where
    jinc(r) = J1(pi r) / (pi r) and sinc(x) = sin(pi x) / (pi x), up to the radius (section 1.1).
    They cut off fine detail equally in all directions. They are not separable, and take longer.

    "least-squares" yields the pixels that come closest to the image once they are enlarged
    bilinearly: they minimize the integral, over the image, of the squared difference between the
    old pixels, as squares, and the new ones, interpolated (figures 1.8 and 7.3).

    Every filter leaves an image of unchanged size as it is. A constant image stays constant at any
    size, except near the edges with "border".

    Args:
        image: (height, width, 1 to 4 channels) or (height, width), scene-linear, row 0 at the
            bottom; encoded colors are decoded first (`to_linear`, or `encoding`). uint8 is divided
            by 255, uint16 by 65535.
        width: Width of the result in pixels, 1 to 2^20.
        height: Height of the result.
        filter: A name of `RESIZE_FILTERS`.
        constrained: Whether values stay in [0, 1]. "least-squares" is solved within these bounds;
            the results of the others are clipped to them.
        ringing: "limit": values stay within the range of the surrounding old pixels, in a square
            with sides of two new pixels, or two old ones if these are wider; so no value is below 0
            unless the image is. "least-squares" is solved within these bounds, the results of the
            others are clipped to them. "allow": values are not limited. "auto": "limit" for
            "least-squares", "allow" for the others.
        wrap: Pixels outside of the image: "clamp" (the nearest pixel), "repeat" or "border" (zero),
            or a pair of these for x and y.
        premultiplied: Whether the colors of an image of 2 or 4 channels are already multiplied by
            alpha, or its last channel is not alpha: then every channel is filtered as it stands.
            Otherwise they are multiplied for filtering and divided afterward; unless alpha is 1
            everywhere, colors stay within the range of visible pixels' colors, and alpha within
            [0, 1].
        encoding: Encoding of integers in the image: "linear", or "srgb", which is decoded for
            filtering and encoded again. The result then has the same integer type, rounded to the
            nearest, and bytes are never converted to floats all at once, which takes a fraction of
            the time. None: the result has floats.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        A new array, (height, width, channels), or (height, width) if the image is: float32, or the
            image's type if `encoding` is given.

    Raises:
        ValueError: An argument is out of range, or a pixel is not finite or beyond 1e30.
        MemoryError: The result does not fit into memory.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.ResizeOptions(), _CHECKS, locals())
    asked = (as_size("width", width), as_size("height", height), options, as_progress(progress))
    if encoding is None:
        return in_form_of(image, _native.resize(as_image("image", image), *asked))
    stored, srgb = as_texels("image", image), is_srgb(encoding)
    resized: npt.NDArray[Any]
    if stored.dtype == np.uint8:
        resized = _native.resize_bytes(stored, srgb, *asked)
    else:
        resized = _native.resize(as_light(stored, srgb, options.threads), *asked)
        if stored.dtype == np.uint16:
            resized = as_words(resized, srgb, options.threads)
    return in_form_of(image, resized)
