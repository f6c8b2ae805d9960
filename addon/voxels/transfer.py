# SPDX-License-Identifier: GPL-3.0-or-later

"""Transfer of materials and layers to a surface from the meshes that it was made of.

Each face of the surface originates from a source triangle. Its corners get the values of the
nearest points on triangles with the same label, so that no face gets values of two objects,
materials or UV charts.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge.layers import COLOR, NORMALS, UV_MAP, VERTEX_GROUP, Layer, NewLayer
from ..bridge.solids import Positions
from ..bridge.target_frame import TargetFrame
from ..core.jobs import Progress, share
from .quads import corners_of, each_half, halves
from .small_sets import NumberedFaces, with_small_sets
from .solid_meshes import SolidMesh, join

_MIN_CHART_CELL_FACES = 4.0
"""Area of a UV chart, in faces of a cell, below which its border is no edge of the surface."""
_ROWS = 1 << 18

Labels = NDArray[np.int32]


@dataclass(frozen=True)
class Source:
    """A mesh as it was read, and as it was voxelized.

    Attributes:
        mesh: The mesh as read.
        positions: (n, 3) as voxelized.
        triangles: (m, 3) as voxelized.
        origins: Triangle of `mesh` that each voxelized triangle came from, or -1; None if the
            triangles are the same.
        labels: Label of each triangle of `mesh`; triangles with the same label may share values at
            a vertex. None if all have the same.
        groups: Group of each voxelized triangle; the surface has edges between groups. None if all
            have the same.
    """

    mesh: SolidMesh
    positions: Positions
    triangles: NDArray[np.integer]
    origins: NDArray[np.int64] | None = None
    labels: Labels | None = None
    groups: Labels | None = None

    @property
    def for_contour(self) -> tuple[Any, ...]:
        """Arrays for `Octree.contour`."""
        arrays = (self.positions, self.triangles)
        return arrays if self.groups is None else (*arrays, self.groups)


def find_labels(mesh: SolidMesh, threads: int) -> Labels | None:
    """Labels triangles by material and UV chart; None if all have the same label."""
    charts = (
        prefilter.uv_charts(mesh.positions, mesh.triangles, mesh.uvs, threads=threads)
        if (mesh.uvs)
        else None
    )
    if charts is None:
        return mesh.materials if mesh.has_several_materials else None
    if not mesh.has_several_materials:
        return charts
    pairs = charts.astype(np.int64) * (int(mesh.materials.max()) + 1) + mesh.materials
    return np.unique(pairs, return_inverse=True)[1].astype(np.int32).reshape(-1)


def find_groups(mesh: SolidMesh, labels: Labels | None, cell: float) -> Labels | None:
    """Derives groups from labels: charts too small for edges along their borders are merged.

    All triangles of such charts form one group per material.
    """
    if labels is None or not mesh.uvs:
        return labels
    areas = np.zeros(int(labels.max()) + 1)
    for start in range(0, len(labels), _ROWS):
        rows = slice(start, start + _ROWS)
        a, b, c = np.moveaxis(mesh.positions[mesh.triangles[rows]].astype(np.float64), 1, 0)
        sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
        areas += np.bincount(labels[rows], sizes, len(areas))
    small = (areas < _MIN_CHART_CELL_FACES * cell**2)[labels]
    if not small.any():
        return labels
    materials = mesh.materials if mesh.has_several_materials else np.zeros(1, np.int32)
    return np.where(small, len(areas) + materials, labels).astype(np.int32)


def groups_of(groups: Labels | None, origins: NDArray[np.int64] | None) -> Labels | None:
    """Groups of voxelized triangles by their origins; triangles without origin get their own."""
    if groups is None or origins is None:
        return groups
    own = int(groups.max()) + 1
    return np.where(origins < 0, own, groups[np.maximum(origins, 0)]).astype(np.int32)


class Transfer:
    """Transfers materials and layers from sources to a surface."""

    def __init__(
        self,
        sources: list[Source],
        positions: NDArray[np.float64],
        faces: NDArray[np.int32],
        origins: NDArray[np.int64] | None,
        cell: float,
        threads: int,
    ) -> None:
        """Keeps the sources and the surface, of triangles or quads.

        `origins` index the triangles of all sources together, None if not known; `cell` is the side
        of a cell.
        """
        self._mesh = join([source.mesh for source in sources])
        self._sources = sources
        self._positions = positions
        self._faces = faces
        self._origins = origins
        self._cell = cell
        self._threads = threads

    def run(
        self, frame: TargetFrame, progress: Progress
    ) -> tuple[NDArray[np.int32] | None, list[NewLayer]]:
        """Returns the materials of faces, None if all have the first, and the new layers.

        Layers are in the object's own space.
        """
        mesh = self._mesh
        if not mesh.has_several_materials and not mesh.layers:
            material = int(mesh.materials[0])
            return np.full(len(self._faces), material, np.int32) if material else None, []
        origins = self._traced(share(progress, 0.0, 0.5))
        materials = mesh.material_of(origins) if mesh.has_several_materials else None
        if not mesh.layers:
            return materials, []
        points = self._points(self._positions, self._faces, origins, share(progress, 0.5, 0.9))
        if any(layer.domain == "FACE" for layer in mesh.layers):
            # Origins have the right label, but need not be near. Find the nearest triangles.
            centers = self._positions[self._faces].mean(axis=1)
            degenerate = np.repeat(np.arange(len(centers), dtype=np.int32)[:, None], 3, axis=1)
            nearest = self._points(centers, degenerate, origins, share(progress, 0.9, 1.0))
            origins = nearest.triangles.astype(np.int32)
        return materials, [self._carried(layer, points, origins, frame) for layer in mesh.layers]

    def _points(
        self,
        positions: NDArray[np.float64],
        faces: NDArray[np.int32],
        origins: NDArray[np.int32],
        progress: Progress,
    ) -> "prefilter.CornerPoints":
        points = prefilter.corner_points(
            positions,
            halves(faces),
            each_half(origins, faces),
            self._mesh.positions,
            self._mesh.triangles,
            self._labels(),
            progress=progress,
            threads=self._threads,
        )
        return replace(points, corners=corners_of(points.corners, faces))

    def _traced(self, progress: Progress) -> NDArray[np.int32]:
        """Triangle of the joined mesh that each face came from, or else the nearest one."""
        count = len(self._faces)
        origins = np.full(count, -1, np.int64)
        if self._origins is not None:
            numbered, start = [], 0
            for source in self._sources:
                own = source.origins
                if own is None:
                    own = np.arange(len(source.mesh.triangles))
                numbered.append(np.where(own < 0, -1, own + start))
                start += len(source.mesh.triangles)
            joined = np.concatenate(numbered)
            origins = np.where(self._origins < 0, -1, joined[np.maximum(self._origins, 0)])
        lost = np.flatnonzero(origins < 0)
        if len(lost):
            centers = self._positions[self._faces[lost]].mean(axis=1)
            origins[lost] = prefilter.nearest_points(
                centers,
                self._mesh.positions,
                self._mesh.triangles,
                progress=progress,
                threads=self._threads,
            )[0]
        return origins.astype(np.int32)

    def _labels(self) -> Labels:
        labels, start = [], 0
        for source in self._sources:
            own = source.labels
            if own is None:
                own = np.zeros(len(source.mesh.triangles), np.int32)
            labels.append(own + start)
            start += int(own.max()) + 1
        return np.concatenate(labels).astype(np.int32)

    def _carried(
        self,
        layer: Layer,
        points: "prefilter.CornerPoints",
        origins: NDArray[np.int32],
        frame: TargetFrame,
    ) -> NewLayer:
        if layer.domain == "FACE":
            return _new_layer(layer, "FACE", self._face_values(layer, origins))
        values = _blended(layer, points)
        has_rims = len(values) > len(self._positions)
        if _goes_to_vertices(layer, has_rims=has_rims):
            return _new_layer(layer, "POINT", values[: len(self._positions)])
        corners = frame.localize_corners(points.corners)
        values = values[corners.ravel()]
        if layer.kind == NORMALS:
            values = frame.localize_normals(self._outward(values))
        return _new_layer(layer, "CORNER", values)

    def _face_values(self, layer: Layer, origins: NDArray[np.int32]) -> NDArray[Any]:
        source_values = layer.values[layer.corners[:, 0]]
        values = source_values[origins]
        if layer.values.dtype.kind == "f" or layer.values.shape[1] > 1:
            return values
        source = NumberedFaces(self._mesh.positions, self._mesh.triangles, source_values[:, 0])
        surface = NumberedFaces(self._positions, self._faces, values[:, 0])
        return with_small_sets(source, surface, self._cell, self._threads)[:, None]

    def _outward(self, normals: NDArray[np.float32]) -> NDArray[np.float32]:
        """Flips corner normals that point inward, as on subtracted objects."""
        a, b, c = np.moveaxis(self._positions[self._faces[:, :3]], 1, 0)
        outside = np.repeat(np.cross(b - a, c - a), self._faces.shape[1], axis=0)
        is_inward = np.einsum("ij,ij->i", outside, normals) < 0.0
        return np.where(is_inward[:, None], -normals, normals)


def _goes_to_vertices(layer: Layer, *, has_rims: bool) -> bool:
    """Whether a layer's values go to vertices, and not to corners."""
    if layer.kind in {UV_MAP, NORMALS}:
        return False
    if layer.kind == VERTEX_GROUP:
        return True
    if layer.kind == COLOR:
        return layer.domain == "POINT" and not has_rims
    return layer.domain == "POINT"


def _blended(layer: Layer, points: "prefilter.CornerPoints") -> NDArray[Any]:
    """Interpolates a layer at points; values that cannot be blended are the nearest corner's."""
    count = len(points.triangles)
    values = np.empty((count, layer.values.shape[1]), layer.values.dtype)
    for start in range(0, count, _ROWS):
        rows = slice(start, start + _ROWS)
        corners = layer.corners[points.triangles[rows]]
        weights = points.weights[rows]
        if layer.is_blended:
            values[rows] = np.einsum("ij,ijk->ik", weights, layer.values[corners])
        elif layer.data_type == "QUATERNION":
            values[rows] = _blended_rotations(layer.values[corners], weights)
        else:
            nearest = weights.argmax(axis=1)
            values[rows] = layer.values[corners[np.arange(len(corners)), nearest]]
    return values


def _blended_rotations(
    rotations: NDArray[np.float32], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Weighted means of three unit quaternions each; opposite signs are the same rotation."""
    cosines = np.einsum("ijk,ik->ij", rotations, rotations[:, 0])
    sums = np.einsum("ij,ijk->ik", np.where(cosines < 0.0, -weights, weights), rotations)
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(lengths > 0.0, sums / np.maximum(lengths, 1e-30), rotations[:, 0])


def _new_layer(layer: Layer, domain: str, values: NDArray[Any]) -> NewLayer:
    return NewLayer(layer.kind, layer.name, layer.data_type, domain, values)


def renumber_materials(meshes: list[SolidMesh], numbers: list[Labels]) -> list[SolidMesh]:
    """Replaces each material index `i` of a mesh by `numbers[mesh][i]`."""
    return [
        replace(mesh, materials=new[mesh.materials])
        for mesh, new in zip(meshes, numbers, strict=True)
    ]
