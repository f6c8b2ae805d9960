# SPDX-License-Identifier: GPL-3.0-or-later

"""Meshes of polygons as files have them, and their triangles."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ... import _native


@dataclass(frozen=True)
class PolygonMesh:
    """A mesh of a file.

    Attributes:
        name: What the file calls it; empty for a mesh without a name.
        positions: (vertices, 3), rounded to single precision.
        corners: (corners,) the vertices of all polygons, one polygon after another.
        sizes: (polygons,) how many corners each has.
        uvs: (corners, 2), rounded likewise; NaN for a corner without. None for a mesh without.
    """

    name: str
    positions: NDArray[np.float64]
    corners: NDArray[np.int64]
    sizes: NDArray[np.int64]
    uvs: NDArray[np.float64] | None

    def triangle_corners(self) -> NDArray[np.int64]:
        """Returns (triangles, 3) indices into `corners`: the polygons, concave ones too."""
        return _native.triangulate_polygons(self.positions, self.corners, self.sizes, None)


def rounded(numbers: object) -> NDArray[np.float64]:
    """Returns numbers in single precision, as Blender keeps them: results are then the same."""
    return np.asarray(numbers, np.float32).astype(np.float64)
