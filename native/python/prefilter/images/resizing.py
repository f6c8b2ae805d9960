# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of other sizes (chapter 1)."""

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
from .pixel_filters import names_for

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
    """The image with another number of pixels, larger or smaller.

    Kernels ("box", "tent", "bspline2", "mitchell", "lanczos2", "lanczos3", "gaussian") filter along
    x and along y. Along each axis they are as wide as the old pixels or the new ones, whichever are
    wider, and an axis whose size stays is left alone. "box" is the mean of the old pixels, as
    squares, over the square of the new one; enlarged, they stay squares.

    "radial2" and "radial3" weigh pixels by their distance r with jinc(r) sinc(r / radius), where
    jinc(r) = J1(pi r) / (pi r) and sinc(x) = sin(pi x) / (pi x), up to the radius (section 1.1).
    They cut off detail that is too fine equally in all directions. They are not separable, and take
    longer.

    "least-squares" gives the pixels that come closest to the image once they are enlarged
    bilinearly: they minimize the integral, over the image, of the squared difference between the
    old pixels, as squares, and the new ones, interpolated (figures 1.8 and 7.3).

    An image of the same size stays as it is, whatever the filter. So does a constant one at any
    size, but for "border" next to its edges.

    Args:
        image: (height, width, 1 to 4 channels) or (height, width), scene-linear, row 0 at the
            bottom; encoded colors are decoded first (`to_linear`, or `encoding`). Bytes (uint8)
            stand for a 255th each, uint16 for a 65535th.
        width: Of the result, in pixels, 1 to 2^20.
        height: Of the result.
        filter: A name of `RESIZE_FILTERS`.
        constrained: Whether values stay in [0, 1]. "least-squares" is solved within these bounds;
            the results of the others are clipped to them.
        ringing: "limit": values stay within the range of the old pixels around, which are those in
            a square of two new pixels a side, or two old ones where these are wider; so none is
            below 0 where the image is not. "least-squares" is solved within these bounds, the
            results of the others are clipped to them. "allow": values go as far as the filter takes
            them. "auto": "limit" for "least-squares", "allow" for the others.
        wrap: What lies outside of the image: "clamp" (its nearest pixel), "repeat" or "border"
            (zero), or a pair of these for x and y.
        premultiplied: Whether the colors of an image of 2 or 4 channels are multiplied by alpha
            already, or its last channel is no alpha: then every channel is filtered as it stands.
            Otherwise they are multiplied for filtering and divided afterward; where alpha is not
            1 everywhere, colors stay within the range that those of visible pixels have, and alpha
            within [0, 1].
        encoding: What integers of the image are: "linear", or "srgb", which is decoded for
            filtering and encoded again. The result then holds such integers too, rounded to the
            nearest, and bytes are never floats all at once, which takes a fraction of the time.
            None: the result is of floats.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        A new array, (height, width, channels), or (height, width) for such an image: float32, or
            with an `encoding` of the image's type.

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
    made: npt.NDArray[Any]
    if stored.dtype == np.uint8:
        made = _native.resize_bytes(stored, srgb, *asked)
    else:
        made = _native.resize(as_light(stored, srgb, options.threads), *asked)
        if stored.dtype == np.uint16:
            made = as_words(made, srgb, options.threads)
    return in_form_of(image, made)
