# SPDX-License-Identifier: GPL-3.0-or-later

"""Marks of edges and vertices: seams, Freestyle marks, weights and other attributes."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .attributes import is_free, is_read, set_values, values_of

_FLAG = "FLAG"
_FLAGS = {"use_seam": "uv_seam", "use_freestyle_mark": "freestyle_edge"}
"""Properties of edges, and the attributes that store them in later Blender versions."""
_WEIGHTS = frozenset({"crease_edge", "bevel_weight_edge", "crease_vert", "bevel_weight_vert"})


@dataclass(frozen=True)
class MarkKind:
    """Kind of mark of edges or vertices.

    Attributes:
        name: Name of Blender's attribute, or of the property of edges.
        data_type: Blender's name of the attribute type, or FLAG for a property.
        domain: EDGE or POINT.
    """

    name: str
    data_type: str
    domain: str


@dataclass(frozen=True)
class Marks:
    """Marked edges or vertices.

    Attributes:
        kind: Kind of the marks.
        ends: Positions of the ends of edges, (k, 2, 3); both are the same for vertices.
        values: (k, c), not 0.
    """

    kind: MarkKind
    ends: NDArray[np.floating]
    values: NDArray[Any]


@dataclass(frozen=True)
class NewMarks:
    """Marks of a new mesh.

    Attributes:
        kind: Kind of the marks.
        values: Values of all edges or vertices, (n, c); 0 where not marked.
    """

    kind: MarkKind
    values: NDArray[Any]


def read_marks(
    mesh: bpy.types.Mesh,
) -> Iterator[tuple[MarkKind, NDArray[np.int32], NDArray[Any]]]:
    """Yields kinds of marks, the vertices of marked edges or vertices, (k, 2), and their values."""
    ends = np.empty((len(mesh.edges), 2), np.int32)
    mesh.edges.foreach_get("vertices", ends.ravel())
    for kind, values in _kinds(mesh):
        marked = np.flatnonzero(values.any(axis=1))
        if not len(marked):
            continue
        vertices = ends[marked]
        if kind.domain == "POINT":
            vertices = np.stack([marked, marked], axis=1).astype(np.int32)
        yield kind, vertices, values[marked]


def write_marks(mesh: bpy.types.Mesh, marks: NewMarks) -> None:
    """Marks the edges or vertices of a mesh."""
    kind = marks.kind
    if kind.data_type == _FLAG:
        mesh.edges.foreach_set(kind.name, marks.values[:, 0])
    else:
        set_values(mesh.attributes.new(kind.name, kind.data_type, kind.domain), marks.values)


def _kinds(mesh: bpy.types.Mesh) -> Iterator[tuple[MarkKind, NDArray[Any]]]:
    flags = {
        name: attribute
        for name, attribute in _FLAGS.items()
        if name in bpy.types.MeshEdge.bl_rna.properties
    }
    for name in flags:
        values = np.empty((len(mesh.edges), 1), np.bool_)
        mesh.edges.foreach_get(name, values.ravel())
        yield MarkKind(name, _FLAG, "EDGE"), values
    for attribute in mesh.attributes:
        if attribute.name in flags.values() or not is_read(attribute):
            continue
        is_weight = attribute.name in _WEIGHTS and attribute.data_type == "FLOAT"
        if is_weight or (attribute.domain == "EDGE" and is_free(attribute)):
            kind = MarkKind(attribute.name, attribute.data_type, attribute.domain)
            yield kind, values_of(attribute)
