# SPDX-License-Identifier: GPL-3.0-or-later

"""What a user has marked edges and vertices with: seams, creases and bevel weights."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

SEAM = "seam"
_EDGE_WEIGHTS = ("crease_edge", "bevel_weight_edge")
_VERTEX_WEIGHTS = ("crease_vert", "bevel_weight_vert")


@dataclass(frozen=True)
class Marks:
    """Marked edges, or vertices.

    Attributes:
        name: SEAM, or that of Blender's attribute.
        ends: (k, 2, 3) in space; of vertices, both are one place.
        values: (k,) float32, above 0.
    """

    name: str
    ends: NDArray[np.floating]
    values: NDArray[np.float32]

    @property
    def is_of_vertices(self) -> bool:
        """Whether it marks vertices."""
        return self.name in _VERTEX_WEIGHTS


@dataclass(frozen=True)
class NewMarks:
    """What a new mesh has of them.

    Attributes:
        name: As of `Marks`.
        values: One for each edge, or vertex; 0 where it is not marked.
    """

    name: str
    values: NDArray[np.float32]


def read_marks(mesh: bpy.types.Mesh) -> Iterator[tuple[str, NDArray[np.int32], NDArray[Any]]]:
    """Yields names of marks, the vertices (k, 2) of what has them, and values above 0."""
    ends = np.empty((len(mesh.edges), 2), np.int32)
    mesh.edges.foreach_get("vertices", ends.ravel())
    seams = np.empty(len(mesh.edges), bool)
    mesh.edges.foreach_get("use_seam", seams)
    if seams.any():
        yield SEAM, ends[seams], np.ones(int(seams.sum()), np.float32)
    for names, of in ((_EDGE_WEIGHTS, ends), (_VERTEX_WEIGHTS, None)):
        for name in names:
            attribute = mesh.attributes.get(name)
            if attribute is None or attribute.data_type != "FLOAT":
                continue
            values = np.empty(len(attribute.data), np.float32)
            attribute.data.foreach_get("value", values)
            marked = np.flatnonzero(values > 0.0)
            if len(marked):
                both = np.stack([marked, marked], axis=1) if of is None else of[marked]
                yield name, both.astype(np.int32), values[marked]


def write_marks(mesh: bpy.types.Mesh, marks: NewMarks) -> None:
    """Marks the edges or vertices of a mesh."""
    if marks.name == SEAM:
        mesh.edges.foreach_set("use_seam", marks.values > 0.0)
        return
    domain = "POINT" if marks.name in _VERTEX_WEIGHTS else "EDGE"
    attribute = mesh.attributes.new(marks.name, "FLOAT", domain)
    attribute.data.foreach_set("value", marks.values)
