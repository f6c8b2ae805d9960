# SPDX-License-Identifier: GPL-3.0-or-later

"""Textures painted from the colors of points."""

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    ProgressCallback,
    Wrap,
    as_number,
    as_progress,
    as_size,
    as_wrap,
)
from .._border.arrays import as_array, as_floats, as_threads
from ..meshes.surface import Surface

_BYTE_MAX = 255.0


def paint_texture(
    surface: Surface,
    points: npt.ArrayLike,
    colors: npt.ArrayLike,
    width: int,
    height: int,
    *,
    smoothing: float = 0.05,
    reach: float | None = None,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float32]:
    """Fits a texture of a surface to the colors of points, such as a scan's to its mesh.

    Each point counts at the point of the surface nearest to it. Texels are fitted by least squares,
    so that bilinear lookups reproduce the colors, and are smooth where points are missing. Only
    level 0 is made; `mipmaps` makes the others. Triangles may be much larger than the point
    spacing.

    Args:
        surface: A mesh with texture coordinates. Charts that overlap get the mean of their points.
        points: (points, 3), in the space of the surface.
        colors: (points, channels), or (points,) for one channel, up to four; uint8 counts in
            255ths. Values are fitted without a change of color space.
        width: Texels along u.
        height: Texels along v.
        smoothing: Weight of smoothness relative to one point per texel, above 0, up to 1e6. More
            averages noise, less keeps detail.
        reach: Points farther than this from the surface are ignored. None: no limit.
        wrap: As for `mipmaps`.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (height, width, channels) float32, or (height, width) where colors are (points,), row 0 at
        v = 0. Values stay within the range of the points' values.

    Raises:
        ValueError: A shape, type or value is wrong; no point counts. Points that are not finite, or
            whose colors are not finite, do not count.
        Cancelled: `progress` returned False.
    """
    if not isinstance(surface, _native.Surface):
        raise ValueError(f"surface: a {type(surface).__name__}; a Surface is needed")
    rows = as_floats("points", points, ("points", 3), np.float64)
    array = as_array("colors", colors)
    shape = (len(rows),) if array.ndim == 1 else (len(rows), "channels")
    values = as_floats("colors", array, shape, np.float32)
    if array.dtype == np.uint8:
        values = values / np.float32(_BYTE_MAX)
    image, _ = _native.paint_texture(
        surface,
        rows,
        values[:, None] if array.ndim == 1 else values,
        as_size("width", width),
        as_size("height", height),
        as_wrap(wrap),
        as_number("smoothing", smoothing),
        None if reach is None else as_number("reach", reach),
        as_progress(progress),
        as_threads(threads),
    )
    return image[:, :, 0] if array.ndim == 1 else image
