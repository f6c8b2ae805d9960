# SPDX-License-Identifier: GPL-3.0-or-later

"""The area covered by a UV map: closed polygons around its charts."""

import bpy
import numpy as np
from numpy.typing import NDArray
from prefilter.workflows.shapes.layouts import borders

from . import attributes

__all__ = ("borders", "has_uv_map", "read_layout")

FloatArray = NDArray[np.float64]


def has_uv_map(obj: bpy.types.Object | None) -> bool:
    """Whether an object is a mesh with a UV map."""
    return obj is not None and obj.type == "MESH" and len(obj.data.uv_layers) > 0


def read_layout(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[FloatArray]:
    """Returns the borders of the area covered by a mesh in its active UV map.

    Modifiers and changes in Edit Mode are included. Overlapping faces have overlapping borders, all
    in the same direction: by the nonzero rule the polygons enclose the union of the faces.

    Args:
        obj: A mesh object.
        depsgraph: The evaluated dependency graph.

    Returns:
        (n, 2) corners of each polygon, in UV space.

    Raises:
        ValueError: It has no UV map, or a UV is not finite.
    """
    evaluated = obj.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        layer = mesh.uv_layers.active
        if layer is None:
            raise ValueError(f"object '{obj.name}' has no UV map")
        uvs = np.empty((len(layer.uv), 2), np.float32)
        layer.uv.foreach_get("vector", uvs.ravel())
        corners, _ = attributes.corner_triangles(mesh)
        name = layer.name
    finally:
        evaluated.to_mesh_clear()
    triangles = uvs[corners]
    if not np.isfinite(triangles).all():
        raise ValueError(f"object '{obj.name}': UV map '{name}' has UVs that are not finite")
    return borders(triangles)
