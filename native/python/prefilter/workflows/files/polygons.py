# SPDX-License-Identifier: GPL-3.0-or-later

"""Polygon meshes as files store them, and their triangulation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ... import _native


@dataclass(frozen=True)
class PolygonMesh:
    """A polygon mesh of a file.

    Attributes:
        name: Its name in the file; empty if it has none.
        positions: (vertices, 3), rounded to single precision.
        corners: (corners,) vertex indices of all polygons, one polygon after another.
        sizes: (polygons,) number of corners of each.
        uvs: (corners, 2), rounded to single precision; NaN for corners without UVs. None for a mesh
            without UVs.
    """

    name: str
    positions: NDArray[np.float64]
    corners: NDArray[np.int64]
    sizes: NDArray[np.int64]
    uvs: NDArray[np.float64] | None

    def triangle_corners(self) -> NDArray[np.int64]:
        """Triangulates the polygons, concave ones too: (triangles, 3) indices into `corners`."""
        return _native.triangulate_polygons(self.positions, self.corners, self.sizes, None)


def rounded(numbers: object) -> NDArray[np.float64]:
    """Rounds numbers to single precision, like Blender, so that results agree."""
    return np.asarray(numbers, np.float32).astype(np.float64)
