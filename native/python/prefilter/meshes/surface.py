# SPDX-License-Identifier: GPL-3.0-or-later

"""Textured surfaces: triangles with texture coordinates."""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Self

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    as_int,
    as_name,
    as_progress,
    set_options,
)
from .._border.arrays import as_array, as_corner_uvs, as_floats, as_indices, check_shape, is_real

Sharp = tuple[npt.ArrayLike, npt.ArrayLike]

_SUBDIVISION_CHECKS: dict[str, Check] = {
    "scheme": partial(as_name, "scheme"),
    "boundary": partial(as_name, "boundary"),
    "uv_smooth": partial(as_name, "uv_smooth"),
    "level": partial(as_int, "level", allowed="a whole number from 1 to 10 is needed"),
}


class Surface(_native.Surface):
    """A textured triangle mesh.

    Triangles of zero area, in space or in the texture, are allowed, and so are charts that overlap,
    are mirrored, or leave the unit square.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices.
        uvs: (triangles, 3, 2) texture coordinates of each triangle's corners, or (vertices, 2) of
            each vertex; the image spans [0, 1], with v = 0 at row 0.
        weights: Importance, 0 and up, which multiplies a triangle's area. (vertices,), or
            (triangles,) or (triangles, 1), or (triangles, 3) for its corners; if there are as many
            triangles as vertices, one axis means vertices. A triangle's weight is the mean of its
            corners' weights, constant over the triangle.

    Attributes:
        triangle_count: The number of triangles.
        area: Total area times weight, in squared units of length.
        positions: (vertices, 3) float64, a copy; so are the others.
        triangles: (triangles, 3) int32.
        uvs: (triangles, 3, 2) float64.
        areas: (triangles,) float64: area of each triangle times its weight.

    Raises:
        ValueError: A shape or type is wrong, there is no triangle, an index names no vertex, a
            value is not finite, or a weight is negative.
    """

    def __init__(
        self,
        positions: npt.ArrayLike,
        triangles: npt.ArrayLike,
        uvs: npt.ArrayLike,
        *,
        weights: npt.ArrayLike | None = None,
    ) -> None:
        points = as_floats("positions", positions, ("vertices", 3), np.float64)
        indices = as_indices("triangles", triangles, ("triangles", 3))
        corners = as_corner_uvs("uvs", uvs, indices, len(points), np.float64)
        importance, kind = _weights(weights, len(points), len(indices), "triangles", corners=3)
        super().__init__(points, indices, corners, importance, kind)

    @classmethod
    def from_subdivision(
        cls,
        positions: npt.ArrayLike,
        face_sizes: npt.ArrayLike,
        face_vertices: npt.ArrayLike,
        face_uvs: npt.ArrayLike,
        *,
        level: int = 3,
        creases: Sharp | None = None,
        corners: Sharp | None = None,
        scheme: str = "catmull-clark",
        boundary: str = "edge-and-corner",
        uv_smooth: str = "preserve-boundaries",
        weights: npt.ArrayLike | None = None,
        faces: npt.ArrayLike | None = None,
        progress: ProgressCallback | None = None,
    ) -> Self:
        """The limit surface of a subdivision mesh, in triangles.

        Faces are refined `level` times, and the vertices then moved to their limit positions, as
        are texture coordinates. Areas approach those of the limit with the square of the triangles'
        size.

        Edges of more than two faces, and vertices where sheets meet, are infinitely sharp. Vertices
        without a face are dropped.

        Args:
            positions: (vertices, 3).
            face_sizes: (faces,) numbers of corners, 3 and up.
            face_vertices: (corners,) indices of vertices, face by face.
            face_uvs: (corners, 2) texture coordinates. Corners of a vertex with equal coordinates
                are joined; others form a seam.
            level: How often faces are refined, 1 to 10. A face of n corners becomes 2 n 4^(level
                - 1) triangles ("loop": 4^level); the total is limited to 2^25.
            creases: Semi-sharp edges, ((creases, 2) vertices, (creases,) sharpness). 0 is smooth,
                10 and up infinitely sharp; so is a sharpness above `level`.
            corners: Sharp vertices, ((corners,) vertices, (corners,) sharpness).
            scheme: "catmull-clark", "loop" (triangles only) or "bilinear".
            boundary: "edge-only": boundaries of the mesh are smooth curves. "edge-and-corner": the
                same, but boundary vertices of a single face do not move.
            uv_smooth: Where texture coordinates stay linear: "smooth-all" nowhere,
                "preserve-corners", "preserve-corners-and-junctions",
                "preserve-corners-junctions-and-concave", "preserve-boundaries" along all borders of
                charts, "none" everywhere.
            weights: As for a `Surface`; (vertices,), interpolated linearly, or (faces,) or
                (faces, 1).
            faces: (faces,) booleans: faces to include. The others still shape the surface.
            progress: Called with the fraction done, in [0, 1]; may return False to stop.

        Raises:
            ValueError: An argument is out of range, a face names a vertex twice, or a crease is no
                edge of a face.
            Cancelled: The progress callback returned False.
        """
        options = set_options(_native.SubdivisionOptions(), _SUBDIVISION_CHECKS, locals())
        mesh = _native.PolygonMesh()
        mesh.positions = as_floats("positions", positions, ("vertices", 3), np.float64)
        mesh.face_sizes = as_indices("face_sizes", face_sizes, ("faces",))
        mesh.face_vertices = as_indices("face_vertices", face_vertices, ("corners",))
        mesh.face_uvs = as_floats("face_uvs", face_uvs, ("corners", 2), np.float64)
        check_shape("face_uvs", mesh.face_uvs, (len(mesh.face_vertices), 2))
        mesh.crease_edges, mesh.crease_sharpness = _sharp("creases", creases, ("creases", 2))
        mesh.corner_vertices, mesh.corner_sharpness = _sharp("corners", corners, ("corners",))
        mesh.weights, mesh.weights_of = _weights(
            weights, len(mesh.positions), len(mesh.face_sizes), "faces", corners=None
        )
        mesh.kept = _mask("faces", faces, len(mesh.face_sizes))
        return cls._take(_native.subdivide(mesh, options, as_progress(progress)))

    def placed(self, matrices: npt.ArrayLike) -> Self:
        """The surface transformed by one or several instance matrices.

        Args:
            matrices: (4, 4) or (instances, 4, 4), or with the first three rows only: affine maps
                of (x, y, z, 1) to a point. Scales may differ by axis and be negative or zero.

        Returns:
            A surface whose triangles have the total area over all instances. Its positions are
            those of the first instance.

        Raises:
            ValueError: There is no matrix, or one is not affine.
        """
        try:
            maps = np.asarray(matrices, np.float64)
        except (TypeError, ValueError) as error:
            raise ValueError(f"matrices: found no array of numbers: {error}") from error
        if maps.ndim == 2:
            maps = maps[None]
        if maps.ndim != 3 or maps.shape[1] not in (3, 4) or maps.shape[2] != 4:
            raise ValueError(
                f"matrices: shape {np.shape(matrices)}; (4, 4), (3, 4) or several of them is needed"
            )
        if maps.shape[1] == 4:
            for i, last in enumerate(maps[:, 3].tolist()):
                if last != [0.0, 0.0, 0.0, 1.0]:
                    raise ValueError(
                        f"matrices: the last row of matrix {i} is {last}; 0, 0, 0, 1 is needed"
                    )
        return self._take(super().placed(np.ascontiguousarray(maps[:, :3])))

    def udim_tile(self, number: int) -> Self | None:
        """The part of the surface in a UDIM tile, moved to the unit square.

        Triangles are cut exactly at the tile's edges, and areas are split accordingly.

        Args:
            number: 1001 + column + 10 * row, up to 9999: the tile where u is from column to
                column + 1 and v from row to row + 1.

        Returns:
            The part, or None if nothing of the surface is in the tile.

        Raises:
            ValueError: The number is no tile's.
        """
        part = super().udim_tile(
            as_int("number", number, "a UDIM tile has a whole number from 1001 to 9999")
        )
        return None if part is None else self._take(part)

    @classmethod
    def merged(cls, surfaces: Iterable["Surface"]) -> list["Surface"]:
        """Joins surfaces that differ in space only, such as the poses of an animated mesh.

        Surfaces with the same triangles and texture coordinates become one with the sum of their
        areas, and the positions of the first. Filters treat it like the list, because weights add
        up: for the frames of an animation it is the average of equation 7.1's weights that section
        7.5 suggests. It takes less time and memory.

        Args:
            surfaces: Any surfaces; those without a match are returned unchanged.

        Returns:
            The joined surfaces, in order of the first of each group.

        Raises:
            ValueError: An item is no Surface.
        """
        if not isinstance(surfaces, Iterable):
            raise ValueError(f"surfaces: a {type(surfaces).__name__}; a list of Surface is needed")
        joined_surfaces: list[Surface] = []
        for surface in surfaces:
            if not isinstance(surface, Surface):
                raise ValueError(f"surfaces: holds a {type(surface).__name__}; a Surface is needed")
            for i, other in enumerate(joined_surfaces):
                joined = other.with_areas_of(surface)
                if joined is not None:
                    joined_surfaces[i] = cls._take(joined)
                    break
            else:
                joined_surfaces.append(surface)
        return joined_surfaces

    @classmethod
    def _take(cls, native: _native.Surface) -> Self:
        """Wraps a native surface."""
        surface = cls.__new__(cls)
        _native.Surface.__init__(surface, native)
        return surface

    def __repr__(self) -> str:
        return f"<prefilter.Surface of {self.triangle_count} triangles, area {self.area:g}>"


def as_surfaces(surface: Surface | Sequence[Surface] | None) -> list[Surface]:
    if surface is None:
        return []
    surfaces = [surface] if isinstance(surface, _native.Surface) else surface
    if not isinstance(surfaces, Sequence):
        raise ValueError(f"surface: a {type(surface).__name__}; a Surface or a list is needed")
    for item in surfaces:
        if not isinstance(item, _native.Surface):
            raise ValueError(f"surface: holds a {type(item).__name__}; a Surface is needed")
    return list(surfaces)


def _weights(
    weights: npt.ArrayLike | None, vertices: int, parts: int, noun: str, *, corners: int | None
) -> tuple[np.ndarray | None, str]:
    """Returns weights and their kind: per vertex, per triangle (or face), or per corner."""
    if weights is None:
        return None, ""
    values = as_array("weights", weights)
    if is_real(values):
        values = np.ascontiguousarray(values, np.float64)
        if values.shape == (vertices,):
            return values, "vertices"
        if values.shape in {(parts,), (parts, 1)}:
            return values.reshape(-1), "triangles"
        if corners is not None and values.shape == (parts, corners):
            return values, "corners"
    allowed = [f"({vertices},) for vertices", f"({parts},) or ({parts}, 1) for {noun}"]
    if corners is not None:
        allowed.append(f"({parts}, {corners}) for corners")
    raise ValueError(
        f"weights: shape {values.shape} of {values.dtype}; real numbers of the shape "
        f"{', '.join(allowed)} are needed"
    )


def _sharp(
    name: str, sharp: Sharp | None, shape: Sequence[int | str]
) -> tuple[np.ndarray, np.ndarray]:
    if sharp is None:
        sharp = (np.empty([0, *shape[1:]], np.int64), np.empty(0))
    if not isinstance(sharp, tuple | list) or len(sharp) != 2:
        raise ValueError(f"{name}: {type(sharp).__name__}; a pair (vertices, sharpness) is needed")
    vertices = as_indices(f"{name}: vertices", sharp[0], shape)
    try:
        sharpness = np.ascontiguousarray(sharp[1], np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: sharpness: found no numbers: {error}") from error
    check_shape(f"{name}: sharpness", sharpness, (len(vertices),))
    return vertices, sharpness


def _mask(name: str, mask: npt.ArrayLike | None, length: int) -> np.ndarray | None:
    if mask is None:
        return None
    values = np.asarray(mask)
    if values.dtype != np.bool_ or values.shape != (length,):
        raise ValueError(
            f"{name}: shape {values.shape} of {values.dtype}; ({length},) of bool is needed"
        )
    return np.ascontiguousarray(values)
