# SPDX-License-Identifier: GPL-3.0-or-later

"""Trimming of reconstructed surfaces where no points support them."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_number, as_progress
from .._border.arrays import as_floats, as_mesh

_MOST_VERTICES = 2**31 - 1


class TrimmedSurface(NamedTuple):
    """A trimmed surface.

    Attributes:
        positions: (vertices, 3) float64.
        triangles: (triangles, 3) int32.
        distance: (vertices,) float32, as given; `limit` at the cut.
        density: (vertices,) float32.
        attributes: (vertices, n) float32; None if none were given.
        cut: Share of the surface, by area, that was cut: 0 to 1.
        islands: Number of small parts removed after the cut.
        island_share: Share of the surface, by area, in these parts.
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

    The cut follows the line at which the distance is `limit`, through triangles, so borders are
    smooth. `reconstruct` does the same unless the surface is to be watertight, and also detects
    large triangles that span a hole with all corners on its rim.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        distance: (vertices,), from the nearest points, in spacings of the points there, as
            `reconstruct` measures it with `support` and `reconstruct_file` writes it.
        density: (vertices,), number of points per area, in the unit of the positions.
        attributes: (vertices, n), preserved, and interpolated where triangles are cut.
        limit: Greatest distance that is kept, 0 to 1e30.
        hole: Holes stay filled, 0 to 1e30: regions farther than `limit` are kept if they nowhere
            exceed this distance and do not reach a border of the surface.
        island: If anything was cut, separate parts are removed whose area corresponds to fewer
            points than this, 0 to 1e30, except the largest part.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        The trimmed surface, which may be empty. If nothing is cut, the mesh is unchanged. Vertices
        without triangles are removed.

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
    left, kept, values, report = _native.trim(
        np.ascontiguousarray(points, np.float64),
        np.ascontiguousarray(indices, np.int32),
        np.ascontiguousarray(np.concatenate(columns, axis=1)),
        as_number("limit", limit),
        as_number("hole", hole),
        as_number("island", island),
        as_progress(progress),
    )
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
