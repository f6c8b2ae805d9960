# SPDX-License-Identifier: GPL-3.0-or-later

"""What a surface gets from the meshes that it was made of: materials, and values of their layers.

Each face of the surface comes from a triangle of a mesh. Values at its corners are those of the
nearest points of triangles with the same label, so that none gets values of two objects, materials
or charts of a UV map.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge.layers import COLOR, NORMALS, UV_MAP, VERTEX_GROUP, Layer, NewLayer
from ..bridge.place import Place
from ..bridge.solids import Positions
from ..core.jobs import Progress, share
from .quads import corners_of, each_half, halves
from .small_sets import NumberedFaces, with_small_sets
from .solid_meshes import SolidMesh, join

_LEAST_CHART = 4.0
"""Area in faces of a cell below which the border of a chart of UVs is no edge of the surface."""
_ROWS = 1 << 18

Labels = NDArray[np.int32]


@dataclass(frozen=True)
class Source:
    """A mesh as it was read, and as it was voxelized.

    Attributes:
        mesh: As read.
        positions: (n, 3) as voxelized.
        triangles: (m, 3) as voxelized.
        origins: For each of these the triangle of the mesh that it came from, or -1; None where
            they are the mesh's own.
        labels: Of the mesh's triangles: those with one number may share values at a vertex. None
            where all do.
        groups: Likewise of the triangles as voxelized: between two the surface has an edge.
    """

    mesh: SolidMesh
    positions: Positions
    triangles: NDArray[np.integer]
    origins: NDArray[np.int64] | None = None
    labels: Labels | None = None
    groups: Labels | None = None

    @property
    def for_contour(self) -> tuple[Any, ...]:
        """The arrays as `Octree.contour` takes them."""
        arrays = (self.positions, self.triangles)
        return arrays if self.groups is None else (*arrays, self.groups)


def find_labels(mesh: SolidMesh, threads: int) -> Labels | None:
    """Returns a number for each triangle, by its material and its chart; None where all are one."""
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
    """Returns the labels without those of charts so small that no edge can follow their borders.

    Their triangles have one group for each material.
    """
    if labels is None or not mesh.uvs:
        return labels
    areas = np.zeros(int(labels.max()) + 1)
    for start in range(0, len(labels), _ROWS):
        rows = slice(start, start + _ROWS)
        a, b, c = np.moveaxis(mesh.positions[mesh.triangles[rows]].astype(np.float64), 1, 0)
        sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
        areas += np.bincount(labels[rows], sizes, len(areas))
    small = (areas < _LEAST_CHART * cell**2)[labels]
    if not small.any():
        return labels
    materials = mesh.materials if mesh.has_several_materials else np.zeros(1, np.int32)
    return np.where(small, len(areas) + materials, labels).astype(np.int32)


def groups_of(groups: Labels | None, origins: NDArray[np.int64] | None) -> Labels | None:
    """Returns the groups of triangles that came from others; those that did not have their own."""
    if groups is None or origins is None:
        return groups
    own = int(groups.max()) + 1
    return np.where(origins < 0, own, groups[np.maximum(origins, 0)]).astype(np.int32)


class Transfer:
    """The meshes that a surface was made of, and the surface."""

    def __init__(
        self,
        sources: list[Source],
        positions: NDArray[np.float64],
        faces: NDArray[np.int32],
        origins: NDArray[np.int64] | None,
        cell: float,
        threads: int,
    ) -> None:
        """Keeps the surface, of triangles or of quads.

        `origins` are of all sources' triangles, or None where not known; `cell` is the side of one.
        """
        self._mesh = join([source.mesh for source in sources])
        self._sources = sources
        self._positions = positions
        self._faces = faces
        self._origins = origins
        self._cell = cell
        self._threads = threads

    def run(
        self, place: Place, progress: Progress
    ) -> tuple[NDArray[np.int32] | None, list[NewLayer]]:
        """Returns the materials of faces, or None where there is one, and all layers.

        Layers are those of the surface in the object's own space.
        """
        mesh = self._mesh
        if not mesh.has_several_materials and not mesh.layers:
            material = int(mesh.materials[0])
            return np.full(len(self._faces), material, np.int32) if material else None, []
        origins = self._traced(share(progress, 0.0, 0.5))
        materials = mesh.material_of(origins) if mesh.has_several_materials else None
        if not mesh.layers:
            return materials, []
        found = self._points(self._positions, self._faces, origins, share(progress, 0.5, 0.9))
        if any(layer.domain == "FACE" for layer in mesh.layers):
            # An origin is of the same label, and need not be near.
            middles = self._positions[self._faces].mean(axis=1)
            each = np.repeat(np.arange(len(middles), dtype=np.int32)[:, None], 3, axis=1)
            near = self._points(middles, each, origins, share(progress, 0.9, 1.0))
            origins = near.triangles.astype(np.int32)
        return materials, [self._carried(layer, found, origins, place) for layer in mesh.layers]

    def _points(
        self,
        positions: NDArray[np.float64],
        faces: NDArray[np.int32],
        origins: NDArray[np.int32],
        progress: Progress,
    ) -> "prefilter.CornerPoints":
        found = prefilter.corner_points(
            positions,
            halves(faces),
            each_half(origins, faces),
            self._mesh.positions,
            self._mesh.triangles,
            self._labels(),
            progress=progress,
            threads=self._threads,
        )
        return replace(found, corners=corners_of(found.corners, faces))

    def _traced(self, progress: Progress) -> NDArray[np.int32]:
        """Returns the triangle of the joined mesh that each face came from."""
        count = len(self._faces)
        origins = np.full(count, -1, np.int64)
        if self._origins is not None:
            of_all, start = [], 0
            for source in self._sources:
                own = source.origins
                if own is None:
                    own = np.arange(len(source.mesh.triangles))
                of_all.append(np.where(own < 0, -1, own + start))
                start += len(source.mesh.triangles)
            joined = np.concatenate(of_all)
            origins = np.where(self._origins < 0, -1, joined[np.maximum(self._origins, 0)])
        lost = np.flatnonzero(origins < 0)
        if len(lost):
            middles = self._positions[self._faces[lost]].mean(axis=1)
            origins[lost] = prefilter.nearest_points(
                middles,
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
        found: "prefilter.CornerPoints",
        origins: NDArray[np.int32],
        place: Place,
    ) -> NewLayer:
        if layer.domain == "FACE":
            return _new_layer(layer, "FACE", self._of_faces(layer, origins))
        values = _blended(layer, found)
        has_rims = len(values) > len(self._positions)
        if _is_of_vertices(layer, has_rims=has_rims):
            return _new_layer(layer, "POINT", values[: len(self._positions)])
        corners = place.localize_corners(found.corners)
        values = values[corners.ravel()]
        if layer.kind == NORMALS:
            values = place.localize_normals(self._facing(values))
        return _new_layer(layer, "CORNER", values)

    def _of_faces(self, layer: Layer, origins: NDArray[np.int32]) -> NDArray[Any]:
        of_source = layer.values[layer.corners[:, 0]]
        values = of_source[origins]
        if layer.values.dtype.kind == "f" or layer.values.shape[1] > 1:
            return values
        source = NumberedFaces(self._mesh.positions, self._mesh.triangles, of_source[:, 0])
        surface = NumberedFaces(self._positions, self._faces, values[:, 0])
        return with_small_sets(source, surface, self._cell, self._threads)[:, None]

    def _facing(self, normals: NDArray[np.float32]) -> NDArray[np.float32]:
        """Returns normals of corners toward the outside: subtracted objects are inside out."""
        a, b, c = np.moveaxis(self._positions[self._faces[:, :3]], 1, 0)
        outside = np.repeat(np.cross(b - a, c - a), self._faces.shape[1], axis=0)
        is_turned = np.einsum("ij,ij->i", outside, normals) < 0.0
        return np.where(is_turned[:, None], -normals, normals)


def _is_of_vertices(layer: Layer, *, has_rims: bool) -> bool:
    """Returns whether a layer's values go to vertices, and not to the corners of triangles."""
    if layer.kind in {UV_MAP, NORMALS}:
        return False
    if layer.kind == VERTEX_GROUP:
        return True
    if layer.kind == COLOR:
        return layer.domain == "POINT" and not has_rims
    return layer.domain == "POINT"


def _blended(layer: Layer, found: "prefilter.CornerPoints") -> NDArray[Any]:
    """Returns a layer's values at points: numbers are interpolated, others the nearest corner's."""
    count = len(found.triangles)
    values = np.empty((count, layer.values.shape[1]), layer.values.dtype)
    for start in range(0, count, _ROWS):
        rows = slice(start, start + _ROWS)
        corners = layer.corners[found.triangles[rows]]
        weights = found.weights[rows]
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
    """Returns unit quaternions between three each; two of opposite sign are one rotation."""
    cosines = np.einsum("ijk,ik->ij", rotations, rotations[:, 0])
    sums = np.einsum("ij,ijk->ik", np.where(cosines < 0.0, -weights, weights), rotations)
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(lengths > 0.0, sums / np.maximum(lengths, 1e-30), rotations[:, 0])


def _new_layer(layer: Layer, domain: str, values: NDArray[Any]) -> NewLayer:
    return NewLayer(layer.kind, layer.name, layer.data_type, domain, values)


def renumbered(meshes: list[SolidMesh], numbers: list[Labels]) -> list[SolidMesh]:
    """Returns meshes with other numbers for their materials: what each was is the index."""
    return [
        replace(mesh, materials=new[mesh.materials])
        for mesh, new in zip(meshes, numbers, strict=True)
    ]
