"""Surfaces: triangles in space with texture coordinates."""

import numpy as np
import numpy.typing as npt

from . import _native
from .arrays import as_floats, as_indices, check_shape


class Surface(_native.Surface):
    """A textured triangle mesh.

    Triangles of zero area, in space or in the texture, are welcome, as are charts that overlap, are
    mirrored, or leave the unit square.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        uvs: (triangles, 3, 2) texture coordinates of each triangle's corners; the image spans
            [0, 1], with v = 0 at row 0.

    Attributes:
        triangle_count: The number of triangles.
        area: Their area in space, squared units of length.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, or a
            value is not finite.
    """

    def __init__(
        self, positions: npt.ArrayLike, triangles: npt.ArrayLike, uvs: npt.ArrayLike
    ) -> None:
        points = as_floats("positions", positions, ("vertices", 3), np.float64)
        indices = as_indices("triangles", triangles, ("triangles", 3))
        corners = as_floats("uvs", uvs, ("triangles", 3, 2), np.float64)
        check_shape("uvs", corners, (len(indices), 3, 2))
        super().__init__(points, indices, corners)

    def __repr__(self) -> str:
        return f"<prefilter.Surface of {self.triangle_count} triangles, area {self.area:g}>"
