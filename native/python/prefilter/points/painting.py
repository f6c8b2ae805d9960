# SPDX-License-Identifier: GPL-3.0-or-later

"""Colors of points on the texture of a surface."""

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

_BYTE = 255.0


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
    """The texture that shows the colors of points on a surface, such as a scan's on its mesh.

    Each point counts where the surface is nearest to it. Texels are those whose bilinear lookups
    come nearest to the colors, by least squares, and are smooth where points do not say: `mipmaps`
    makes the levels. Triangles may be much larger than the distance between points.

    Args:
        surface: A mesh with texture coordinates. Charts that overlap get the mean of their points.
        points: (points, 3), in the space of the surface.
        colors: (points, channels), or (points,) for one channel, up to four; uint8 stands for a
            255th. Values are fitted as they are.
        width: Texels along u.
        height: Texels along v.
        smoothing: Above 0, up to 1e6: how much smoothness counts, compared with a point in each
            texel. More averages noise, less keeps detail.
        reach: Points that are farther than this from the surface do not count. None: all do.
        wrap: As for `mipmaps`.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (height, width, channels) float32, or (height, width) where colors are (points,), row 0 at
        v = 0. Values stay within the range of those of the points.

    Raises:
        ValueError: A shape, type or value is wrong; no point counts. Points that are not finite, or
            whose colors are not, do not.
        Cancelled: `progress` returned False.
    """
    if not isinstance(surface, _native.Surface):
        raise ValueError(f"surface: a {type(surface).__name__}; a Surface is needed")
    rows = as_floats("points", points, ("points", 3), np.float64)
    found = as_array("colors", colors)
    shape = (len(rows),) if found.ndim == 1 else (len(rows), "channels")
    values = as_floats("colors", found, shape, np.float32)
    if found.dtype == np.uint8:
        values = values / np.float32(_BYTE)
    image, _ = _native.paint_texture(
        surface,
        rows,
        values[:, None] if found.ndim == 1 else values,
        as_size("width", width),
        as_size("height", height),
        as_wrap(wrap),
        as_number("smoothing", smoothing),
        None if reach is None else as_number("reach", reach),
        as_progress(progress),
        as_threads(threads),
    )
    return image[:, :, 0] if found.ndim == 1 else image
