# SPDX-License-Identifier: GPL-3.0-or-later

"""Occupancy octrees: the share of each cell that is inside of a shape."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    as_int,
    as_items,
    as_name,
    as_number,
    as_progress,
    set_options,
)
from .._border.arrays import as_floats, as_labels, as_mesh, as_threads
from .contours import CLEANUP_CHECKS
from .lost_parts import find_lost_parts
from .thin_places import ThinPlaces

Corner = Sequence[float] | npt.NDArray[np.floating]
Box = tuple[Corner, Corner]
Source = tuple[npt.ArrayLike, npt.ArrayLike] | tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike]
"""A mesh: positions, triangles and maybe a group, a whole number, for each triangle."""

MAX_DEPTH = _native.MAX_DEPTH


def _as_isovalue(isovalue: float) -> float:
    level = as_number("isovalue", isovalue)
    if not 0.0 < level <= 1.0:
        raise ValueError(f"isovalue: {isovalue!r}; a number above 0 and up to 1 is needed")
    return level


_CONTOUR_CHECKS: dict[str, Check] = {
    **CLEANUP_CHECKS,
    "interpolant": partial(as_name, "interpolant"),
    "isovalue": _as_isovalue,
}

_QUAD_CHECKS: dict[str, Check] = {
    "interpolant": partial(as_name, "interpolant"),
    "threads": as_threads,
}


class Octree(_native.Octree):
    """Occupancies of the cells of a box, refined along the surface of a shape.

    Cells of depth k are the 2^k x 2^k x 2^k parts of the box; a leaf's value is the share of it
    that is inside of the shape, from 0 to 1. Made by `voxelize`, `load`, and the set operations.

    Attributes:
        depth: The finest cells are 2^depth along an axis.
        bounds: (low corner, high corner) of the box.
        volume: Volume of the shape, in cubed units of length.
        node_count: Number of cells of all depths, including the root.
        nbytes: Memory of the octree in bytes.
    """

    def __init__(self, octree: _native.Octree) -> None:
        """Wraps an octree; both share the cells, which never change."""
        if not isinstance(octree, _native.Octree):
            raise ValueError(f"octree: a {type(octree).__name__}; an Octree is needed")
        super().__init__(octree)

    @property
    def thin_places(self) -> ThinPlaces:
        """Places where the mesh was thinner than the `thickness` that was passed to `voxelize`."""
        return ThinPlaces(*_native.thin_triangles(self, False))

    @property
    def thin_walls(self) -> ThinPlaces:
        """The `thin_places` between faces that are parallel within 10 degrees.

        This excludes wedges and tips, which no cell size preserves entirely. The thickness of a
        triangle is the one that nine tenths of the wall below it have at least.
        """
        return ThinPlaces(*_native.thin_triangles(self, True))

    def dense(
        self,
        depth: int | None = None,
        *,
        progress: ProgressCallback | None = None,
        threads: int = 0,
    ) -> npt.NDArray[np.float32]:
        """The occupancies of all cells of a depth.

        Args:
            depth: 0 to 12; None for the octree's own. Values are means where the tree is finer, and
                the leaf's value where it is coarser.
            progress: Called with the fraction done; returning False stops the work.
            threads: 0 means all processors.

        Returns:
            (n, n, n) float32, n = 2^depth, indexed [x, y, z].

        Raises:
            ValueError: `depth` is out of range.
            MemoryError: The grid would not fit into memory.
            Cancelled: `progress` returned False.
        """
        grid_depth = self.depth if depth is None else _as_depth(depth, 0)
        return _native.dense_values(self, grid_depth, as_progress(progress), as_threads(threads))

    def values(self, points: npt.ArrayLike, *, threads: int = 0) -> npt.NDArray[np.float32]:
        """The occupancies of the leaves that hold the points; 0 outside of the bounds.

        Args:
            points: (points, 3).
            threads: 0 means all processors.
        """
        return _native.values_at(self, _as_points(points), as_threads(threads))

    def classify(
        self, points: npt.ArrayLike, *, tolerance: float = 1e-5, threads: int = 0
    ) -> npt.NDArray[np.int8]:
        """Whether points are inside (1), outside (-1) or near the surface (0).

        A point is near the surface if its leaf's occupancy differs from both 0 and 1 by more than
        `tolerance`: the surface passes through it, or the mesh is open close by.

        Args:
            points: (points, 3).
            tolerance: From 0 up to, but not including, 0.5.
            threads: 0 means all processors.
        """
        limit = as_number("tolerance", tolerance)
        if not 0.0 <= limit < 0.5:
            raise ValueError(f"tolerance: {tolerance!r}; a number from 0 to below 0.5 is needed")
        return _native.classify(self, _as_points(points), limit, as_threads(threads))

    def box_occupancy(self, low: Corner, high: Corner) -> float:
        """The share of a box that is inside of the shape, as the exact integral over the cells.

        Args:
            low: The low corner, (3,).
            high: The high corner, above it along each axis. The box may leave the bounds, where
                everything is empty.
        """
        return _native.box_occupancy(self, _as_box("box", (low, high)))

    def union(
        self, other: "Octree", *, progress: ProgressCallback | None = None, threads: int = 0
    ) -> "Octree":
        """The union of two shapes: max(a, b), cell by cell.

        Depths and bounds may differ. If bounds differ, the other's cells are resampled to this
        one's grid, exactly if the two grids share corners and as means otherwise, and the box is
        doubled until it holds both.

        Raises:
            ValueError: `other` is no Octree, or the box would need a depth of more than 12.
            Cancelled: `progress` returned False.
        """
        return _combined(self, other, "union", progress, threads)

    def intersection(
        self, other: "Octree", *, progress: ProgressCallback | None = None, threads: int = 0
    ) -> "Octree":
        """The intersection: min(a, b), cell by cell, in this one's bounds. See `union`."""
        return _combined(self, other, "intersection", progress, threads)

    def difference(
        self, other: "Octree", *, progress: ProgressCallback | None = None, threads: int = 0
    ) -> "Octree":
        """The difference: min(a, 1 - b), cell by cell, in this one's bounds. See `union`."""
        return _combined(self, other, "difference", progress, threads)

    def contour(
        self,
        *,
        interpolant: str = "sharp",
        isovalue: float = 0.5,
        sources: Sequence[Source] | None = None,
        cleanup: bool = True,
        adaptivity: float = 0.0,
        progress: ProgressCallback | None = None,
        threads: int = 0,
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
        """The surface of the shape: marching cubes on the dual grid of the leaves (chapter 5).

        The mesh is closed and two-manifold for any octree, and leaves of different sizes cause no
        cracks. Everything outside of the bounds is empty.

        Args:
            interpolant: How a vertex is placed between the centers of two leaves. "occupancy"
                preserves the filled share of each of the two (section 5.2); "plane" fits the
                surface to the surrounding leaves, and reproduces planes; "linear" is marching
                cubes; "sharp", the default, is "plane" with the edges and corners of the shape.
            isovalue: Above 0 and up to 1. Leaves of at least this occupancy are inside. For values
                other than 0.5, interpolation is linear.
            sources: The meshes that the shape was made of, each (positions, triangles) or
                (positions, triangles, groups), for "sharp": vertices are placed on their edges,
                corners and intersections; no triangle crosses an edge, or a border between groups,
                (triangles,) integers. Without sources, edges are derived from the occupancies,
                where flat or gently curved faces of a few cells meet.
            cleanup: Remove narrow triangles, which also reduces their number.
            adaptivity: Largest distance of the surface from the full contour, in cells of the
                finest depth, by which triangles may grow on flat and gently curved parts. 0.1 is
                hardly visible, and leaves a fifth of the triangles of a statue, and a twentieth of
                those of a machine part. 0 is the full contour.
            progress: Called with the fraction done; returning False stops the work.
            threads: 0 means all processors. The result does not depend on it.

        Returns:
            Positions (vertices, 3) float64, in the units of the bounds, and triangles
            (triangles, 3) int32, counter-clockwise seen from outside. Before rounding positions
            to float32, subtract a point of the bounds: far from the origin, float32 cannot
            distinguish vertices.

        Raises:
            ValueError: `interpolant` is unknown, or `isovalue` or `adaptivity` is out of range.
            MemoryError: The surface would not fit into memory.
            Cancelled: `progress` returned False.
        """
        options = set_options(_native.ContourOptions(), _CONTOUR_CHECKS, locals())
        return _native.contour_octree(self, _as_sources(sources), options, as_progress(progress))

    def traced_contour(
        self,
        sources: Sequence[Source],
        *,
        cleanup: bool = True,
        adaptivity: float = 0.0,
        progress: ProgressCallback | None = None,
        threads: int = 0,
    ) -> "TracedContour":
        """The contour by "sharp", and the source triangle that each of its triangles shows.

        This allows transferring attributes such as materials and UV maps without crossing an edge,
        a rim or a seam. See `contour`.

        Args:
            sources: As for `contour`, at least one.
            cleanup: As for `contour`.
            adaptivity: As for `contour`.
            progress: Called with the fraction done; returning False stops the work.
            threads: 0 means all processors. The result does not depend on it.

        Raises:
            ValueError: There is no source, one is no mesh, or `adaptivity` is out of range.
            MemoryError: The surface would not fit into memory.
            Cancelled: `progress` returned False.
        """
        options = set_options(_native.ContourOptions(), CLEANUP_CHECKS, locals())
        return TracedContour(
            *_native.traced_contour(self, _as_sources(sources), options, as_progress(progress))
        )

    def quad_contour(
        self,
        *,
        interpolant: str = "sharp",
        sources: Sequence[Source] | None = None,
        progress: ProgressCallback | None = None,
        threads: int = 0,
    ) -> "QuadContour":
        """The surface of the shape as quads only: dual contouring (Ju et al. 2002).

        The mesh is closed and two-manifold for any octree: a vertex for each part of the surface in
        a cell of the dual grid, and a quad for each pair of neighbors inside and outside, about
        half as many as `contour` makes triangles. Everything outside of the bounds is empty.

        Args:
            interpolant: As for `contour`. With "sharp", vertices are on edges and corners.
            sources: As for `contour`; no quad crosses an edge of theirs, or a border between
                groups.
            progress: Called with the fraction done; returning False stops the work.
            threads: 0 means all processors. The result does not depend on it.

        Raises:
            ValueError: `interpolant` is unknown, or a source is no mesh.
            MemoryError: The surface would not fit into memory.
            Cancelled: `progress` returned False.
        """
        options = set_options(_native.ContourOptions(), _QUAD_CHECKS, locals())
        positions, quads, origins = _native.contour_quads(
            self, _as_sources(sources), options, as_progress(progress)
        )
        return QuadContour(positions, quads, origins if len(origins) == len(quads) else None)

    def lost_parts(
        self,
        positions: npt.ArrayLike,
        triangles: npt.ArrayLike,
        part_of: npt.ArrayLike,
        *,
        threads: int = 0,
    ) -> npt.NDArray[np.int64]:
        """The parts of a mesh that vanished in voxelization.

        A part is lost if none of its triangles is inside of the shape or within a cell of its
        contour. Parts beyond the bounds do not count as lost.

        Args:
            positions: (vertices, 3), of the mesh that the octree was made of.
            triangles: (triangles, 3) integer indices of vertices.
            part_of: (triangles,) integers from 0: the part of each, as from `mesh_topology`;
                negative for none.
            threads: 0 means all processors.

        Returns:
            (lost,) int64: the numbers of the lost parts, in ascending order.

        Raises:
            ValueError: A shape or type is wrong, or an index names no vertex.
        """
        points, indices = as_mesh(positions, triangles)
        if len(indices) and not 0 <= indices.min() <= indices.max() < len(points):
            raise ValueError(
                f"triangles: vertices {indices.min()} to {indices.max()}; there are {len(points)}"
            )
        parts = as_labels("part_of", part_of, len(indices), "triangles")
        return find_lost_parts(self, points, indices, parts, as_threads(threads))

    def coarsened(self, depth: int) -> "Octree":
        """The octree limited to a depth of 0 to 12; finer cells are averaged."""
        return Octree(_native.coarsened(self, _as_depth(depth, 0)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the octree as a compressed NumPy archive (.npz).

        The file is staged beside `path` and renamed, so a failure leaves an earlier file intact. A
        symbolic link is followed, and its target replaced.

        Raises:
            ValueError: `path` is no path.
            OSError: The file can't be written, or is a device or a pipe.
        """
        from .octree_files import write_octree

        write_octree(path, self)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Reads a file written by `save`.

        Raises:
            OSError: The file can't be read.
            ValueError: The file holds no octree, or is damaged.
            MemoryError: The octree would not fit into memory.
        """
        from .octree_files import read_octree

        return cls(read_octree(path))


def _combined(
    octree: Octree, other: Octree, operation: str, progress: ProgressCallback | None, threads: int
) -> Octree:
    if not isinstance(other, _native.Octree):
        raise ValueError(f"other: a {type(other).__name__}; an Octree is needed")
    return Octree(
        _native.combine(octree, other, operation, as_progress(progress), as_threads(threads))
    )


@dataclass(frozen=True)
class TracedContour:
    """A contour, and the origins of its triangles.

    Attributes:
        positions: (vertices, 3) float64.
        triangles: (triangles, 3) int32, counter-clockwise seen from outside.
        origins: (triangles,) int64: a source triangle for each, numbered across all sources, from
            the same source, group and smooth region. It need not be the nearest one.
    """

    positions: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int32]
    origins: npt.NDArray[np.int64]


@dataclass(frozen=True)
class QuadContour:
    """A contour of quads.

    Attributes:
        positions: (vertices, 3) float64.
        quads: (quads, 4) int32, counter-clockwise seen from outside. They are flat, or nearly so,
            along the diagonal from the first corner to the third.
        origins: (quads,) int64: as for `TracedContour`; None without sources, or for interpolants
            other than "sharp".
    """

    positions: npt.NDArray[np.float64]
    quads: npt.NDArray[np.int32]
    origins: npt.NDArray[np.int64] | None


def voxelize(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    *,
    depth: int = 8,
    bounds: Box | None = None,
    thickness: float = 0.0,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> Octree:
    """The occupancy of every cell of a grid: the share of it that is inside of a mesh.

    Values are exact (Haar wavelet coefficients by integrals over the surface, section 3.2.3), in
    memory and time proportional to the surface. The mesh may be open, leaky, or self-intersecting;
    points with a winding number of at least 1 are inside. A hole affects only the cells around it.
    A mesh that is inside out encloses nothing.

    Args:
        positions: (vertices, 3), in any unit of length.
        triangles: (triangles, 3) integer indices of vertices, counter-clockwise from outside.
        depth: 1 to 12; the grid has 2^depth cells along each axis.
        bounds: (low corner, high corner) of the grid; its cells need not be cubes. Parts outside of
            it are cut off. None for `cube_around` the mesh.
        thickness: Cells: thinner parts of the solid are thickened to this, and rods by a quarter
            more, so that a contour stays connected, always from 1.5 on. Parts that touch or overlap
            count as one solid; edges of more than 45 degrees are preserved. In these cells a
            contour has no edges of its sources, and no origins. 0: all occupancies are exact.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: A shape or type is wrong, `depth` is out of range, there is no triangle or none
            with an area, an index names no vertex, a value is not finite, `thickness` is negative,
            or `bounds` have no volume.
        MemoryError: The octree would not fit into memory.
        Cancelled: `progress` returned False.
    """
    points, indices = as_mesh(positions, triangles)
    box = None if bounds is None else _as_box("bounds", bounds)
    return Octree(
        _native.voxelize(
            points,
            indices,
            _as_depth(depth, 1),
            box,
            as_number("thickness", thickness),
            as_progress(progress),
            as_threads(threads),
        )
    )


def cube_around(bounds: Box, *, depth: int = 8) -> tuple[np.ndarray, np.ndarray]:
    """The default bounds of `voxelize` for a mesh in a box: (low corner, high corner) of a cube.

    Along the box's longest axis two cells stay free on both sides, or an eighth of the cells if
    there are fewer than 16 along an axis.

    Args:
        bounds: (low corner, high corner) of the box.
        depth: 1 to 12; the cube has 2^depth cells along each axis.

    Raises:
        ValueError: A shape or type is wrong, or `depth` is out of range.
    """
    low, high = _native.cube_around(_as_box("bounds", bounds), _as_depth(depth, 1))
    return np.array(low), np.array(high)


def _as_sources(
    sources: Sequence[Source] | None,
) -> list[tuple[npt.NDArray[np.floating], npt.NDArray[np.integer], npt.NDArray[np.int32]]]:
    if sources is None:
        return []
    checked = []
    for i, source in enumerate(as_items("sources", sources, "a list of meshes")):
        if not isinstance(source, (tuple, list)) or len(source) not in (2, 3):
            raise ValueError(
                f"sources: item {i} is a {type(source).__name__}; (positions, triangles) or "
                "(positions, triangles, groups) is needed"
            )
        mesh = as_mesh(
            source[0], source[1], names=(f"sources[{i}] positions", f"sources[{i}] triangles")
        )
        groups = np.empty(0, np.int32)
        if len(source) == 3:
            groups = as_labels(f"sources[{i}] groups", source[2], len(mesh[1]), "triangles")
        checked.append((*mesh, groups))
    return checked


def _as_depth(depth: int, lowest: int) -> int:
    return as_int("depth", depth, f"a whole number from {lowest} to {MAX_DEPTH} is needed")


def _as_points(points: npt.ArrayLike) -> np.ndarray:
    values = as_floats("points", points, ("points", 3), np.float64)
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values).all(axis=1)))
        raise ValueError(f"points: row {row} is {values[row]}; all values must be finite")
    return values


def _as_box(name: str, box: Box) -> tuple[list[float], list[float]]:
    try:
        corners = np.asarray(box, np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: {box!r}; two corners of 3 numbers are needed") from error
    if corners.shape != (2, 3):
        raise ValueError(f"{name}: shape {corners.shape}; two corners, (2, 3), are needed")
    return corners[0].tolist(), corners[1].tolist()
