# SPDX-License-Identifier: GPL-3.0-or-later

"""New meshes of surfaces, with materials and attributes, and the objects that show them."""

import math
from collections.abc import Generator, Sequence, Set
from dataclasses import dataclass, field

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from ..core.wording import Sentence
from . import kept_sources
from .layers import COLOR, NORMALS, SHADED_KEY, UV_MAP, VERTEX_GROUP, NewLayer, write_layer
from .marks import NewMarks, write_marks
from .solids import SOLID_TYPES, MaterialKey

_HAS_FREE_NORMALS = bpy.app.version >= (4, 5, 0)
_FEW_FACES = 200_000
"""Number of faces up to which custom normals that follow deformations take less than a second."""
_KEPT = (
    *(f"use_mirror_{name}" for name in ("x", "y", "z", "vertex_groups", "topology")),
    *(f"remesh_{name}" for name in ("mode", "voxel_size", "voxel_adaptivity")),
    *(f"use_remesh_{name}" for name in ("fix_poles", "preserve_volume", "preserve_attributes")),
    *("use_auto_texspace", "texspace_location", "texspace_size"),
)
"""Settings of a mesh that its replacement keeps, such as symmetric sculpting."""
_WEIGHT_STEPS = 65535
"""Weights of vertex groups are rounded to 1/65535: vertices with one weight are added together."""


@dataclass(frozen=True)
class Contour:
    """A surface in the space of its object.

    Attributes:
        positions: (n, 3) float32.
        faces: (m, 3) int32, or (m, 4) for quads.
        materials: Materials by index.
        face_materials: (m,) int32; None if there is at most one material.
        layers: Its attributes; vertex groups belong to the object, and normals are set last.
        active: Names of the active color attribute and UV map, by kind.
        rendered: Names of the color attribute and UV map used by renders, by kind.
        sharp_angle: Angle in radians above which edges are sharp; None for flat shading.
        edges: Its edges; None: Blender finds them, on the main thread.
        normals: Computed corner normals, (3 m, 3) float32; None for Blender's.
        marks: Marks of its edges and vertices; they need `edges`.
        locked_groups: Names of vertex groups with locked weights.
        kept_modifiers: Names of modifiers that the object keeps.
        made: Its mesh, once made and until an object shows it.
    """

    positions: NDArray[np.float32]
    faces: NDArray[np.int32]
    materials: Sequence[MaterialKey | None] = ()
    face_materials: NDArray[np.int32] | None = None
    layers: Sequence[NewLayer] = ()
    active: dict[str, str] = field(default_factory=dict)
    rendered: dict[str, str] = field(default_factory=dict)
    sharp_angle: float | None = None
    edges: "prefilter.MeshEdges | None" = None
    normals: NDArray[np.float32] | None = None
    marks: Sequence[NewMarks] = ()
    locked_groups: Set[str] = frozenset()
    kept_modifiers: Set[str] = frozenset()
    made: list[bpy.types.Mesh] = field(default_factory=list)


def is_editable(obj: bpy.types.Object) -> bool:
    """Whether an object's mesh can be replaced."""
    return obj.library is None and obj.override_library is None


def check_editable(obj: bpy.types.Object) -> None:
    """Raises ValueError if an object's mesh cannot be replaced."""
    if obj.library is not None:
        text = "object '{}' is linked from '{}'; make it local first"
        raise ValueError(Sentence(text, obj.name, obj.library.filepath))
    if obj.override_library is not None:
        text = "object '{}' is a library override; make it local first"
        raise ValueError(Sentence(text, obj.name))


def new_mesh(name: str, contour: Contour) -> bpy.types.Mesh:
    """Returns a mesh datablock of a surface; makes it unless `making_mesh` did."""
    for _ in making_mesh(contour):
        pass
    mesh = contour.made.pop()
    mesh.name = name
    return mesh


def making_mesh(contour: Contour) -> Generator[None, None, None]:
    """Makes a mesh datablock of a surface in steps, for `new_mesh`."""
    if contour.made:
        return
    mesh = bpy.data.meshes.new("Surface")
    try:
        yield from _fill(mesh, contour)
    except BaseException:
        bpy.data.meshes.remove(mesh)
        raise
    contour.made.append(mesh)


def forget_mesh(contour: Contour) -> None:
    """Removes the mesh of `making_mesh`, if no object shows it."""
    for mesh in contour.made:
        bpy.data.meshes.remove(mesh)
    contour.made.clear()


def _fill(mesh: bpy.types.Mesh, contour: Contour) -> Generator[None, None, None]:
    count, sides = contour.faces.shape
    mesh.vertices.add(len(contour.positions))
    yield
    mesh.loops.add(sides * count)
    yield
    mesh.polygons.add(count)
    yield
    mesh.attributes["position"].data.foreach_set(
        "vector", np.ascontiguousarray(contour.positions, np.float32).ravel()
    )
    yield
    mesh.polygons.foreach_set("loop_start", np.arange(0, sides * count, sides, dtype=np.int32))
    yield
    # Writing whole arrays to attributes is a hundred times faster than to loops and polygons.
    mesh.attributes[".corner_vert"].data.foreach_set(
        "value", np.ascontiguousarray(contour.faces, np.int32).ravel()
    )
    yield
    for key in contour.materials:
        mesh.materials.append(key.find() if key is not None else None)
    if contour.face_materials is not None and contour.face_materials.any():
        indices = mesh.attributes.new("material_index", "INT", "FACE")
        indices.data.foreach_set("value", contour.face_materials)
    for layer in contour.layers:
        if layer.kind not in {VERTEX_GROUP, NORMALS}:
            write_layer(mesh, layer)
            yield
    _add_edges(mesh, contour)
    yield
    if contour.sharp_angle is None:
        mesh.shade_flat()
    else:
        mesh.shade_smooth()
    if contour.sharp_angle is not None and contour.sharp_angle < math.pi:
        mesh.set_sharp_from_angle(angle=contour.sharp_angle)
    _choose_active(mesh, contour)
    yield
    for layer in contour.layers:
        if layer.kind == NORMALS:
            is_deformed = any(other.kind == VERTEX_GROUP for other in contour.layers)
            _set_normals(mesh, layer.values, is_deformed=is_deformed)
    if contour.normals is not None:
        _set_normals(mesh, contour.normals, is_deformed=count <= _FEW_FACES)
        mesh[SHADED_KEY] = True


def _set_normals(mesh: bpy.types.Mesh, values: NDArray[np.float32], *, is_deformed: bool) -> None:
    """Sets the normals of corners.

    As an attribute they are exact and set at once, but do not follow deformations of the mesh.
    Blender's custom normals do, but take five seconds per million faces.
    """
    if _HAS_FREE_NORMALS and not is_deformed:
        normals = mesh.attributes.new("custom_normal", "FLOAT_VECTOR", "CORNER")
        normals.data.foreach_set("vector", np.ascontiguousarray(values, np.float32).ravel())
        mesh.update()
    else:
        mesh.normals_split_custom_set(values)


def _add_edges(mesh: bpy.types.Mesh, contour: Contour) -> None:
    edges = contour.edges
    if edges is None or (edges.corners < 0).any():
        mesh.update(calc_edges=True)
        return
    mesh.edges.add(len(edges.vertices))
    mesh.attributes[".edge_verts"].data.foreach_set("value", edges.vertices.ravel())
    mesh.attributes[".corner_edge"].data.foreach_set("value", edges.corners.ravel())
    mesh.update()
    for marks in contour.marks:
        write_marks(mesh, marks)


def show_contour(
    obj: bpy.types.Object, contour: Contour, *, keeps_source: bool = False
) -> bpy.types.Object:
    """Makes an object show a surface, or a new one if it is no mesh; returns that object.

    A mesh object gets a new mesh, and loses the modifiers and instances that the surface already
    includes. Other objects are hidden, and a new mesh object is added.

    Args:
        obj: The object.
        contour: The surface.
        keeps_source: Whether the original is kept.
    """
    if obj.type == "MESH":
        source = kept_sources.copy_source(obj) if keeps_source else None
        _replace_mesh(obj, contour, source)
        if source is not None:
            kept_sources.keep(obj, [source])
        return obj
    made = new_object_beside(obj, new_mesh(obj.name, contour), ".voxels")
    _add_groups(made, contour)
    obj.hide_set(True)
    obj.hide_render = True
    if keeps_source:
        kept_sources.keep(made, [obj])
    return made


def show_again(obj: bpy.types.Object, contour: Contour) -> bpy.types.Object:
    """Makes an object show another surface, with its modifiers; returns the object."""
    replace_data(obj, new_mesh(obj.data.name, contour))
    _add_groups(obj, contour)
    return obj


def replace_data(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> None:
    """Replaces the mesh of an object; the new one gets the old name if that becomes free."""
    old, name = obj.data, obj.data.name
    _keep_settings(old, mesh)
    obj.data = mesh
    if old.users == 0 and old.library is None:
        bpy.data.meshes.remove(old)
        mesh.name = name


def new_object_beside(obj: bpy.types.Object, data: bpy.types.ID, suffix: str) -> bpy.types.Object:
    """Adds an object in the position and collections of another one, and selects it instead."""
    made = bpy.data.objects.new(f"{obj.name}{suffix}", data)
    root = bpy.context.scene.collection
    for collection in obj.users_collection:
        is_in_scene = collection == root or collection in root.children_recursive
        if is_in_scene and collection.library is None:
            collection.objects.link(made)
    if not made.users_collection:
        root.objects.link(made)
    made.matrix_world = obj.matrix_world
    made.select_set(True)
    layer = bpy.context.view_layer.objects
    if layer.active == obj:
        layer.active = made
    obj.select_set(False)
    return made


def is_solid(obj: bpy.types.Object) -> bool:
    """Whether an object may show a solid."""
    return obj.type in SOLID_TYPES or (obj.type == "EMPTY" and obj.is_instancer)


def _replace_mesh(obj: bpy.types.Object, contour: Contour, source: bpy.types.Object | None) -> None:
    """Replaces an object's mesh and modifiers; the new mesh gets the old name if possible."""
    old = obj.data
    mesh = new_mesh(old.name, contour)
    _keep_settings(old, mesh)
    for modifier in list(obj.modifiers):
        if modifier.name not in contour.kept_modifiers:
            obj.modifiers.remove(modifier)
    obj.instance_type = "NONE"
    obj.data = mesh
    _add_groups(obj, contour)
    if source is not None and old.users == 1 and old.library is None:
        name = old.name
        old.name = source.name
        mesh.name = name
    elif old.users == 0 and old.library is None:
        name = old.name
        bpy.data.meshes.remove(old)
        mesh.name = name


def _keep_settings(old: bpy.types.Mesh, new: bpy.types.Mesh) -> None:
    for name in _KEPT:
        if old.use_auto_texspace and name.startswith("texspace"):
            continue
        setattr(new, name, getattr(old, name))


def _choose_active(mesh: bpy.types.Mesh, contour: Contour) -> None:
    colors, maps = mesh.color_attributes, mesh.uv_layers
    if contour.active.get(COLOR, "") in colors:
        colors.active_color_name = contour.active[COLOR]
    if contour.rendered.get(COLOR, "") in colors:
        colors.render_color_index = colors.find(contour.rendered[COLOR])
    if contour.active.get(UV_MAP, "") in maps:
        maps.active = maps[contour.active[UV_MAP]]
    if contour.rendered.get(UV_MAP, "") in maps:
        maps[contour.rendered[UV_MAP]].active_render = True


def _add_groups(obj: bpy.types.Object, contour: Contour) -> None:
    for layer in contour.layers:
        if layer.kind != VERTEX_GROUP:
            continue
        group = obj.vertex_groups.new(name=layer.name)
        group.lock_weight = layer.name in contour.locked_groups
        steps = np.round(np.clip(layer.values[:, 0], 0.0, 1.0) * _WEIGHT_STEPS).astype(np.int64)
        order = np.argsort(steps, kind="stable")
        weights, starts = np.unique(steps[order], return_index=True)
        for step, members in zip(weights, np.split(order, starts[1:]), strict=True):
            if step:
                group.add(members.tolist(), float(step / _WEIGHT_STEPS), "REPLACE")
