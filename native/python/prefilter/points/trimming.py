# SPDX-License-Identifier: GPL-3.0-or-later

"""Surfaces of scans that end where the points do."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_number, as_progress
from .._border.arrays import as_floats, as_mesh

_MOST_VERTICES = 2**31 - 1


class TrimmedSurface(NamedTuple):
    """What is left of a surface.

    Attributes:
        positions: (vertices, 3) float64.
        triangles: (triangles, 3) int32.
        distance: (vertices,) float32, as it was; `limit` where the surface was cut.
        density: (vertices,) float32.
        attributes: (vertices, n) float32; None if none were given.
        cut: The share of the surface, by area, that was cut: from 0 to 1.
        islands: How many small parts were then left out.
        island_share: Their share of the surface.
    """

    positions: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int32]
    distance: npt.NDArray[np.float32]
    density: npt.NDArray[np.float32]
    attributes: npt.NDArray[np.float32] | None
    cut: float
    islands: int
    island_share: float


def trim(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    distance: npt.ArrayLike,
    density: npt.ArrayLike,
    *,
    attributes: npt.ArrayLike | None = None,
    limit: float = 1.5,
    hole: float = 4.0,
    island: float = 12.0,
    progress: ProgressCallback | None = None,
) -> TrimmedSurface:
    """Cuts a reconstructed surface where no points support it, without another reconstruction.

    The cut is the line at which the distance is `limit`, so triangles are cut, too, and borders are
    smooth. `reconstruct` does the same unless it is told to make a closed surface, but also knows
    where a large triangle spans a hole whose rim its corners lie on.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        distance: (vertices,) from the nearest points, in spacings of the points there, as
            `reconstruct` finds it with `support`, and `reconstruct_file` writes it.
        density: (vertices,) the number of points to an area, in the unit of the positions.
        attributes: (vertices, n), kept, and interpolated where triangles are cut.
        limit: What is farther is cut. 0 to 1e30, as the two that follow.
        hole: But not what fills a hole: regions in which nothing is farther than this, and that do
            not reach an end of the surface.
        island: Where anything was cut, parts go whose area is that of fewer points than this, but
            for the largest part.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        What is left; it may be nothing. If nothing is cut, the mesh is as it was. Vertices that no
        triangle has are left out.

    Raises:
        ValueError: A shape, type or value is wrong.
        Cancelled: `progress` returned False.
    """
    points, indices = as_mesh(positions, triangles)
    count = len(points)
    columns = [
        as_floats(name, values, (count,), np.float32)[:, np.newaxis]
        for name, values in (("distance", distance), ("density", density))
    ]
    if attributes is not None:
        columns.insert(0, as_floats("attributes", attributes, (count, "n"), np.float32))
    outside = indices[(indices < 0) | (indices >= min(count, _MOST_VERTICES))]
    if len(outside):
        raise ValueError(f"triangles: index {outside[0]}; there are {count} vertices")
    if not np.isfinite(points).all():
        raise ValueError("positions: some are not finite; all must be")
    found = _native.trim(
        np.ascontiguousarray(points, np.float64),
        np.ascontiguousarray(indices, np.int32),
        np.ascontiguousarray(np.concatenate(columns, axis=1)),
        as_number("limit", limit),
        as_number("hole", hole),
        as_number("island", island),
        as_progress(progress),
    )
    left, kept, values, report = found
    return TrimmedSurface(
        left,
        kept,
        values[:, -2].copy(),
        values[:, -1].copy(),
        None if attributes is None else values[:, :-2].copy(),
        report["cut"],
        int(report["islands"]),
        report["island_share"],
    )
