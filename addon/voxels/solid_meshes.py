"""Arithmetic on what solids are made of: one mesh, right side out, and what is wrong with it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..bridge.solids import Colors, Part, Solid

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

_LEAST_VOLUME = 1e-6
"""Share of the box around a mesh below which its volume has no sign to speak of."""
_WHITE = np.ones((1, 4), np.float32)


@dataclass(frozen=True)
class SolidMesh:
    """The parts of solids as one mesh.

    Attributes:
        positions: (n, 3) float64.
        triangles: (m, 3) int32, counter-clockwise from outside.
        materials: (m,) int32.
        colors: Its colour attributes; parts that lack one are white there.
        open_edges: How many edges its faces do not close.
        flipped: How many parts were inside out.
    """

    positions: FloatArray
    triangles: IntArray
    materials: IntArray
    colors: dict[str, Colors]
    open_edges: int = 0
    flipped: int = 0

    @cached_property
    def box(self) -> tuple[FloatArray, FloatArray]:
        """The corners of the box around the triangles."""
        used = self.positions[np.unique(self.triangles)]
        return used.min(axis=0), used.max(axis=0)

    @cached_property
    def area(self) -> float:
        """The area of the triangles."""
        return float(np.linalg.norm(_area_vectors(self.positions, self.triangles), axis=1).sum())

    def has_several_materials(self) -> bool:
        """Returns whether the triangles differ in their materials."""
        return bool(np.any(self.materials != self.materials[:1]))


def solid_mesh(solid: Solid) -> SolidMesh:
    """Joins the parts of a solid; those that are inside out as a whole are turned."""
    turned = [_is_inside_out(part) for part in solid.parts]
    joined = join(
        [_as_mesh(part, turn=turn) for part, turn in zip(solid.parts, turned, strict=True)]
    )
    return SolidMesh(
        joined.positions,
        joined.triangles,
        joined.materials,
        joined.colors,
        count_open_edges(joined.positions, joined.triangles),
        sum(turned),
    )


def join(meshes: list[SolidMesh]) -> SolidMesh:
    """Returns one mesh of all the triangles."""
    if len(meshes) == 1:
        return meshes[0]
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    return SolidMesh(
        np.concatenate([mesh.positions for mesh in meshes]),
        np.concatenate(
            [mesh.triangles + start for mesh, start in zip(meshes, starts[:-1], strict=True)]
        ).astype(np.int32),
        np.concatenate([mesh.materials for mesh in meshes]),
        _joined_colors(meshes),
    )


def signed_volume(positions: FloatArray, triangles: IntArray) -> float:
    """Returns the volume that triangles enclose as seen from the middle of their box."""
    if len(triangles) == 0:
        return 0.0
    used = positions[triangles]
    middle = (used.min(axis=(0, 1)) + used.max(axis=(0, 1))) / 2
    a, b, c = np.moveaxis(used - middle, 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def count_open_edges(positions: FloatArray, triangles: IntArray) -> int:
    """Returns how many edges are not run through as often one way as the other.

    Vertices at the same place count as one, so that seams between them are none.
    """
    count = _unmatched_edges(triangles)
    return _unmatched_edges(_welded(positions)[triangles]) if count else 0


def _unmatched_edges(triangles: NDArray[np.integer]) -> int:
    ends = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    ends = ends[ends[:, 0] != ends[:, 1]]
    if len(ends) == 0:
        return 0
    keys = (ends.min(axis=1) << 32) | ends.max(axis=1)
    order = np.argsort(keys)
    keys = keys[order]
    ways = np.where(ends[order, 0] < ends[order, 1], 1, -1)
    starts = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))
    return int(np.count_nonzero(np.add.reduceat(ways, starts)))


def _welded(positions: FloatArray) -> NDArray[np.int64]:
    """Returns a number for each vertex, the same for vertices at the same place."""
    rows = np.ascontiguousarray(positions + 0.0).view([("", np.float64)] * 3).ravel()
    return np.unique(rows, return_inverse=True)[1]


def _is_inside_out(part: Part) -> bool:
    used = part.positions[part.triangles]
    box = np.prod(used.max(axis=(0, 1)) - used.min(axis=(0, 1)))
    return signed_volume(part.positions, part.triangles) < -_LEAST_VOLUME * float(box)


def _as_mesh(part: Part, *, turn: bool) -> SolidMesh:
    if not turn:
        return SolidMesh(part.positions, part.triangles, part.materials, part.colors)
    colors = {
        name: Colors(color.data_type, color.values, color.corners[:, ::-1])
        for name, color in part.colors.items()
    }
    return SolidMesh(part.positions, part.triangles[:, ::-1], part.materials, colors)


def _joined_colors(meshes: list[SolidMesh]) -> dict[str, Colors]:
    types: dict[str, str] = {}
    for mesh in meshes:
        for name, color in mesh.colors.items():
            types.setdefault(name, color.data_type)
    joined = {}
    for name, data_type in types.items():
        values, corners, start = [], [], 0
        for mesh in meshes:
            white = Colors(data_type, _WHITE, np.zeros_like(mesh.triangles))
            color = mesh.colors.get(name, white)
            values.append(color.values)
            corners.append(color.corners + start)
            start += len(color.values)
        joined[name] = Colors(
            data_type, np.concatenate(values), np.concatenate(corners).astype(np.int32)
        )
    return joined


def _area_vectors(positions: FloatArray, triangles: IntArray) -> FloatArray:
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    return np.cross(b - a, c - a) / 2
