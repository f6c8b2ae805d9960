# SPDX-License-Identifier: GPL-3.0-or-later

"""Triangles of objects that show an image, for drawing with the GPU."""

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from .materials import ImageUse, image_uses


@dataclass(frozen=True)
class Triangles:
    """Triangles with UVs, in the space of an object.

    Attributes:
        positions: (3 n, 3).
        uvs: (3 n, 2).
    """

    positions: NDArray[np.float32]
    uvs: NDArray[np.float32]


def triangles_with(
    obj: bpy.types.Object, image: bpy.types.Image, depsgraph: bpy.types.Depsgraph
) -> Triangles | None:
    """Copies the triangles of an evaluated object whose material shows an image.

    Args:
        obj: A visible object.
        image: The image.
        depsgraph: The evaluated dependency graph.

    Returns:
        The triangles; None if there are none.
    """
    shown = obj.evaluated_get(depsgraph)
    mesh = shown.data if isinstance(shown.data, bpy.types.Mesh) else None
    # In Edit Mode the mesh has no position attribute.
    if mesh is None or not mesh.uv_layers or "position" not in mesh.attributes:
        return None
    uses = [_use(slot.material, image) for slot in shown.material_slots]
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    corners, materials = np.empty(3 * len(triangles), np.int32), np.empty(len(triangles), np.int32)
    triangles.foreach_get("loops", corners)
    triangles.foreach_get("material_index", materials)
    vertices = np.empty(3 * len(triangles), np.int32)
    triangles.foreach_get("vertices", vertices)
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", positions)
    kept, uvs = np.zeros(len(triangles), bool), np.zeros((len(corners), 2), np.float32)
    for index, use in enumerate(uses):
        if use is not None:
            chosen = np.minimum(materials, len(uses) - 1) == index
            kept |= chosen
            wide = np.repeat(chosen, 3)
            uvs[wide] = _mapped(mesh, use, corners[wide])
    if not kept.any():
        return None
    wide = np.repeat(kept, 3)
    return Triangles(positions.reshape(-1, 3)[vertices[wide]], uvs[wide])


def _use(material: bpy.types.Material | None, image: bpy.types.Image) -> ImageUse | None:
    """First way in which a material samples an image."""
    uses = image_uses(material, image)[0] if material is not None else []
    return uses[0] if uses else None


def _mapped(mesh: bpy.types.Mesh, use: ImageUse, corners: NDArray[np.int32]) -> NDArray[np.float32]:
    layers = mesh.uv_layers
    active = next((layer for layer in layers if layer.active_render), layers[0])
    layer = layers.get(use.uv_map, active) if use.uv_map else active
    values = np.empty(2 * len(mesh.loops), np.float32)
    layer.uv.foreach_get("vector", values)
    matrix = np.array(use.transform, np.float32)
    return values.reshape(-1, 2)[corners] @ matrix[:, :2].T + matrix[:, 2]
