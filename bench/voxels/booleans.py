# SPDX-License-Identifier: GPL-3.0-or-later

"""Booleans of closed meshes by manifold3d, the truth that octrees are compared with."""

import importlib.util
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import measures
from .sharp_shapes import Shape

OPERATORS = {"union": "__add__", "intersection": "__xor__", "difference": "__sub__"}


def missing() -> str:
    """Returns the missing requirement; empty if there is none."""
    return "" if importlib.util.find_spec("manifold3d") else "manifold3d (PyPI)"


def combined(shapes: Sequence[Shape], operation: str) -> tuple[Shape, measures.Edges]:
    """Combines two shapes; returns the result and the edges where faces of both meet.

    Raises:
        ValueError: manifold3d refuses one of them.
    """
    first, second = (_solid(shape) for shape in shapes)
    made = getattr(first, OPERATORS[operation])(second)
    mesh = made.to_mesh64()
    positions = np.asarray(mesh.vert_properties, np.float64)[:, :3]
    triangles = _merged(mesh, np.asarray(mesh.tri_verts, np.int64))
    runs = np.asarray(mesh.run_index) // 3
    owner = np.repeat(np.asarray(mesh.run_original_id), np.diff(runs))
    result = Shape(operation, positions, triangles)
    ends, faces, degrees = measures.edges(positions, triangles)
    rim = owner[faces[:, 0]] != owner[faces[:, 1]]
    return result, measures.Edges(positions[ends[rim]], degrees[rim])


def _solid(shape: Shape) -> Any:
    import manifold3d

    mesh = manifold3d.Mesh64(shape.positions, shape.triangles.astype(np.uint64))
    made = manifold3d.Manifold(mesh).as_original()
    if made.status() != manifold3d.Error.NoError:
        raise ValueError(f"{shape.name}: manifold3d says {made.status()}")
    return made


def _merged(mesh: Any, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    vertex = np.arange(len(mesh.vert_properties))
    vertex[np.asarray(mesh.merge_from_vert, np.int64)] = mesh.merge_to_vert
    return vertex[triangles]
