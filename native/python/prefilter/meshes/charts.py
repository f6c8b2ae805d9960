# SPDX-License-Identifier: GPL-3.0-or-later

"""The charts of UV maps."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_items, as_progress
from .._border.arrays import as_corner_uvs, as_mesh, as_threads


def uv_charts(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    uvs: Sequence[npt.ArrayLike],
    *,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.int32]:
    """Labels the groups of triangles that are connected in all of several UV maps.

    Two triangles are connected if they share an edge that no other triangle has, with equal UVs at
    both ends, within 1e-4. Vertices at the same position count as one. A chart that meets itself at
    a seam, such as the side of a tube, is cut about half way around, so that connected triangles
    have equal UVs at a vertex.

    Args:
        positions: (vertices, 3).
        triangles: (triangles, 3) integer indices of vertices.
        uvs: For each map, (triangles, 3, 2): the UVs of the triangles' corners; or (vertices, 2).
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (triangles,) int32: equal numbers, from 0, for connected triangles.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, or a
            position is not finite.
        Cancelled: `progress` returned False.
    """
    points, indices = as_mesh(positions, triangles)
    maps = [
        as_corner_uvs(f"uvs[{i}]", uv_map, indices, len(points), np.float32)
        for i, uv_map in enumerate(as_items("uvs", uvs, "a list of UV maps"))
    ]
    return _native.uv_charts(points, indices, maps, as_progress(progress), as_threads(threads))
