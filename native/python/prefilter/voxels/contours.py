# SPDX-License-Identifier: GPL-3.0-or-later

"""Contouring of sample grids: outlines and closed meshes."""

from functools import partial

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    as_name,
    as_number,
    as_progress,
    set_options,
)
from .._border.arrays import as_floats, as_threads

Mesh = tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]
Outlines = list[npt.NDArray[np.float64]]


def _as_isovalue(isovalue: float) -> float:
    level = as_number("isovalue", isovalue)
    if not np.isfinite(level):
        raise ValueError(f"isovalue: {isovalue!r}; a finite number is needed")
    return level


CLEANUP_CHECKS: dict[str, Check] = {
    "cleanup": bool,
    "adaptivity": partial(as_number, "adaptivity"),
    "threads": as_threads,
}
"""Checks of the arguments that all contour functions share."""
_CHECKS: dict[str, Check] = {
    **CLEANUP_CHECKS,
    "interpolant": partial(as_name, "interpolant"),
    "isovalue": _as_isovalue,
}


def contour(
    grid: npt.ArrayLike,
    *,
    interpolant: str = "occupancy",
    isovalue: float = 0.5,
    spacing: npt.ArrayLike = 1.0,
    origin: npt.ArrayLike = 0.0,
    cleanup: bool = True,
    adaptivity: float = 0.0,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> Mesh | Outlines:
    """The surface of a 3D grid, or the outlines of a 2D one (chapter 5).

    Cell (i, j, k) spans origin + spacing x [i, i + 1) x [j, j + 1) x [k, k + 1), and its sample is
    at its center. Outside of the grid everything is empty, so surfaces and outlines are closed. A
    surface is two-manifold for any samples.

    Args:
        grid: (x, y, z), or (x, y) for outlines; 1 to 4096 samples along each axis.
        interpolant: How a vertex is placed between two samples. "occupancy" interprets them as the
            filled shares of two cells, and preserves the share of each (section 5.2); "plane" fits
            the surface to the surrounding cells, and reproduces planes; "linear" interprets them as
            a smooth function, as marching cubes does. Samples out of [0, 1], or another iso-value
            than 0.5, are interpolated linearly.
        isovalue: Samples of at least this are inside.
        spacing: Size of a cell, above 0: one number, or one per axis.
        origin: The low corner of cell (0, 0, 0): one number, or one per axis.
        cleanup: Remove narrow triangles of a surface, which also reduces their number.
        adaptivity: Largest distance of the surface from the full contour, in cells along their
            shortest side, by which triangles may grow. 0 is the full contour.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        For a 3D grid positions (vertices, 3) float64 and triangles (triangles, 3) int32,
        counter-clockwise seen from outside. For a 2D grid a list of closed outlines, each
        (points, 2) float64, the last point connected to the first, with the inside to the left.

    Raises:
        ValueError: A shape or type is wrong, a sample is not finite, `interpolant` is unknown,
            `adaptivity` is out of range, `spacing` is not above 0, or cells have no volume because
            of rounding at `origin`.
        MemoryError: The surface would not fit into memory.
        Cancelled: `progress` returned False.
    """
    options = set_options(_native.ContourOptions(), _CHECKS, locals())
    axes = np.ndim(grid)
    shape = ("x", "y") if axes == 2 else ("x", "y", "z")
    samples = as_floats("grid", grid, shape, np.float32)
    size = _as_vector("spacing", spacing, axes)
    if min(size) <= 0.0:
        raise ValueError(f"spacing: {spacing!r}; sizes above 0 are needed")
    corner = _as_vector("origin", origin, axes)
    if axes == 2:
        return _native.contour_outlines(samples, size, corner, options, as_progress(progress))
    return _native.contour_grid(samples, size, corner, options, as_progress(progress))


def _as_vector(name: str, value: npt.ArrayLike, axes: int) -> list[float]:
    try:
        numbers = np.asarray(value, np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: {value!r}; one number, or one an axis, is needed") from error
    if numbers.shape not in ((), (axes,)):
        raise ValueError(f"{name}: shape {numbers.shape}; one number, or ({axes},), is needed")
    if not np.isfinite(numbers).all():
        raise ValueError(f"{name}: {value!r}; finite numbers are needed")
    return [float(number) for number in np.broadcast_to(numbers, axes)]
