# SPDX-License-Identifier: GPL-3.0-or-later

"""Points on solids whose surface is known, and objects that have them."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import bodies
import bpy
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAJOR, MINOR = 1.0, 0.4
TORUS_VOLUME = 2 * np.pi**2 * MAJOR * MINOR**2


def torus(count: int = 20_000, seed: int = 1) -> tuple[Array, Array]:
    """Returns points of a torus around z, uniform by area, and its normals there."""
    random = np.random.default_rng(seed)
    v = random.uniform(0, 2 * np.pi, 2 * count)
    # A ring of the tube counts as much as it is long.
    v = v[random.uniform(0, MAJOR + MINOR, 2 * count) < MAJOR + MINOR * np.cos(v)][:count]
    u = random.uniform(0, 2 * np.pi, len(v))
    outward = np.stack([np.cos(u), np.sin(u), np.zeros_like(u)], axis=1)
    up = np.array([0.0, 0.0, 1.0])
    normals = np.cos(v)[:, None] * outward + np.sin(v)[:, None] * up
    return MAJOR * outward + MINOR * normals, normals


def torus_distance(points: Array) -> Array:
    """Returns how far points are from that torus, above 0 outside."""
    ring = np.hypot(points[:, 0], points[:, 1]) - MAJOR
    return np.hypot(ring, points[:, 2]) - MINOR


def sphere(count: int = 20_000, seed: int = 1) -> tuple[Array, Array]:
    """Returns points of the unit sphere, and its normals there."""
    found = np.random.default_rng(seed).normal(size=(count, 3))
    found /= np.linalg.norm(found, axis=1)[:, None]
    return found, found


def scan(
    positions: Array,
    normals: Array | None = None,
    name: str = "Scan",
    attributes: Mapping[str, tuple[str, Array]] | None = None,
    **placed: Sequence[float],
) -> bpy.types.Object:
    """Makes a selected, active mesh object of points, as imports of scans do.

    Args:
        positions: (n, 3).
        normals: (n, 3).
        name: Name of the object.
        attributes: Type and values, by name.
        placed: Properties such as `location`.
    """
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    _set(mesh.attributes["position"], "vector", positions)
    if normals is not None:
        _set(mesh.attributes.new("normal", "FLOAT_VECTOR", "POINT"), "vector", normals)
    for key, (data_type, values) in (attributes or {}).items():
        field = "color" if data_type.endswith("COLOR") else "value"
        _set(mesh.attributes.new(key, data_type, "POINT"), field, values)
    return bodies.body(name, mesh, **placed)


def file(path: Path, positions: Array, *columns: Array) -> Path:
    """Writes lines of x, y, z, and of more columns such as (n, 3) normals or bytes of colors."""
    rows = [
        " ".join(f"{value:.9g}" for value in row)
        for row in np.concatenate([positions, *columns], axis=1)
    ]
    path.write_text("\n".join([*rows, ""]))
    return path


def points(obj: bpy.types.Object) -> Array:
    """Returns the points of a mesh or a point cloud, in the space of the object."""
    attribute = obj.data.attributes["position"]
    found = np.empty((len(attribute.data), 3), np.float32)
    attribute.data.foreach_get("vector", found.ravel())
    return found


def vertices(obj: bpy.types.Object) -> Array:
    """Returns the vertices of a mesh object in world space."""
    found = np.empty((len(obj.data.vertices), 3), np.float32)
    obj.data.attributes["position"].data.foreach_get("vector", found.ravel())
    matrix = np.array(obj.matrix_world)
    return found @ matrix[:3, :3].T + matrix[:3, 3]


def _set(attribute: bpy.types.Attribute, field: str, values: Array) -> None:
    attribute.data.foreach_set(field, np.ascontiguousarray(values, np.float32).ravel())
