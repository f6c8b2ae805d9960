# SPDX-License-Identifier: GPL-3.0-or-later

"""Subdivision modifiers: their control meshes and limit surfaces."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from . import attributes

_LEVEL = 3
# Limit for a refined mesh; the areas of finer meshes are accurate enough without refinement.
_MAX_TRIANGLES = 1 << 21

_BOUNDARIES = {"ALL": "edge-only", "PRESERVE_CORNERS": "edge-and-corner"}


@dataclass(frozen=True)
class Rules:
    """Settings of a modifier.

    Attributes:
        boundary: As for `prefilter.Surface.from_subdivision`.
        uv_smooth: As for `prefilter.Surface.from_subdivision`.
        level: As for `prefilter.Surface.from_subdivision`.
        use_creases: Whether creases count.
    """

    boundary: str
    uv_smooth: str
    level: int
    use_creases: bool

    @classmethod
    def of(cls, modifier: bpy.types.SubsurfModifier, mesh: bpy.types.Mesh) -> "Rules | None":
        """Reads a modifier on a mesh; None if the mesh is too fine to be refined."""
        level = _LEVEL
        while level > 0 and len(mesh.loops) * 4**level // 2 > _MAX_TRIANGLES:
            level -= 1
        if level == 0:
            return None
        return cls(
            boundary=_BOUNDARIES[modifier.boundary_smooth],
            uv_smooth=modifier.uv_smooth.lower().replace("_", "-"),
            level=level,
            use_creases=modifier.use_creases,
        )


def top_modifier(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> bpy.types.SubsurfModifier | None:
    """Returns the last enabled modifier if it is a Catmull-Clark modifier; else None."""
    shown = "show_viewport" if depsgraph.mode == "VIEWPORT" else "show_render"
    editing = obj.mode == "EDIT"
    enabled = [
        m for m in obj.modifiers if getattr(m, shown) and (not editing or m.show_in_editmode)
    ]
    if not enabled or enabled[-1].type != "SUBSURF":
        return None
    modifier = enabled[-1]
    if modifier.subdivision_type != "CATMULL_CLARK":
        return None
    return modifier if max(modifier.levels, modifier.render_levels) > 0 else None


@contextmanager
def without(
    obj: bpy.types.Object,
    modifier: bpy.types.SubsurfModifier,
    depsgraph: bpy.types.Depsgraph,
) -> Iterator[bool]:
    """Evaluates the object without the modifier, and again with it at the end.

    Yields whether that worked: a driver or an animation may keep the modifier enabled.
    """
    shown = "show_viewport" if depsgraph.mode == "VIEWPORT" else "show_render"
    setattr(modifier, shown, False)
    try:
        depsgraph.update()
        yield not getattr(obj.evaluated_get(depsgraph).modifiers[modifier.name], shown)
    finally:
        setattr(modifier, shown, True)
        depsgraph.update()


def limit_surface(
    mesh: bpy.types.Mesh,
    chosen: NDArray[np.bool_],
    uvs: NDArray[np.float64],
    weights: attributes.Weights | None,
    rules: Rules,
) -> prefilter.Surface:
    """Returns the limit surface of faces of a control mesh.

    Args:
        mesh: The mesh below the modifier.
        chosen: Mask of the faces.
        uvs: UVs of all corners.
        weights: Importance.
        rules: Settings of the modifier.

    Raises:
        ValueError: The geometry is invalid.
    """
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    vertices = attributes.corner_vertices(mesh)
    sharp: dict[str, Any] = _creases(mesh) if rules.use_creases else {}
    return prefilter.Surface.from_subdivision(
        attributes.positions(mesh),
        np.diff(starts, append=np.int32(len(vertices))),
        vertices,
        uvs,
        level=rules.level,
        boundary=rules.boundary,
        uv_smooth=rules.uv_smooth,
        weights=None if weights is None else _control_mesh_weights(weights, vertices, mesh),
        faces=chosen,
        **sharp,
    )


def _creases(mesh: bpy.types.Mesh) -> dict[str, tuple[NDArray[np.int32], NDArray[np.float64]]]:
    creases = {}
    if "crease_edge" in mesh.attributes:
        crease = np.empty(len(mesh.edges), np.float32)
        mesh.attributes["crease_edge"].data.foreach_get("value", crease)
        corner_edges = np.empty(len(mesh.loops), np.int32)
        mesh.attributes[".corner_edge"].data.foreach_get("value", corner_edges)
        edges = np.empty((len(mesh.edges), 2), np.int32)
        mesh.edges.foreach_get("vertices", edges.ravel())
        chosen = np.intersect1d(corner_edges, np.flatnonzero(crease > 0))
        creases["creases"] = edges[chosen], _sharpness(crease[chosen])
    if "crease_vert" in mesh.attributes:
        crease = np.empty(len(mesh.vertices), np.float32)
        mesh.attributes["crease_vert"].data.foreach_get("value", crease)
        chosen = np.flatnonzero(crease > 0).astype(np.int32)
        creases["corners"] = chosen, _sharpness(crease[chosen])
    return creases


def _sharpness(crease: NDArray[np.float32]) -> NDArray[np.float64]:
    """Sharpness of a crease in Blender; 10 is infinite."""
    return 10.0 * np.square(np.clip(crease, 0.0, 1.0), dtype=np.float64)


def _control_mesh_weights(
    weights: attributes.Weights, vertices: NDArray[np.int32], mesh: bpy.types.Mesh
) -> NDArray[np.float64]:
    """Weights of vertices or faces; corner weights are averaged per vertex."""
    if weights.domain == "POINT":
        return weights.values
    if weights.domain == "FACE":
        return weights.values[:, None]
    count = np.bincount(vertices, minlength=len(mesh.vertices))
    total = np.bincount(vertices, weights.values, minlength=len(mesh.vertices))
    return total / np.maximum(count, 1)
