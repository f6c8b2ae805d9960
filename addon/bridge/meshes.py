"""Evaluated meshes to `prefilter.Surface`: the part of each mesh that wears an image."""

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from .materials import ImageUse, image_uses, images_of

_WHOLE_IMAGE = ImageUse("", ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), "REPEAT")


@dataclass
class ImageSurfaces:
    """The surfaces that an image is mapped on.

    Attributes:
        surfaces: One for each object and each way in which its materials sample the image.
        objects: The name of the object that each surface comes from.
        extensions: What the Image Texture nodes do outside of the image, most common first.
        problems: What was left out and why.
    """

    surfaces: list[prefilter.Surface] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    extensions: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _Triangles:
    """Arrays of an evaluated mesh; positions are in world space."""

    positions: NDArray[np.float64]
    corners: NDArray[np.int32]
    vertices: NDArray[np.int32]
    materials: NDArray[np.int32]


def image_surfaces(
    objects: Iterable[bpy.types.Object],
    image: bpy.types.Image,
    depsgraph: bpy.types.Depsgraph,
    *,
    all_faces: bool = False,
) -> ImageSurfaces:
    """Copies the faces that use an image, with the UVs that they use it with.

    Meshes are evaluated (modifiers, shape keys, edit mode) and in world space, so that the areas of
    different objects compare.

    Args:
        objects: Objects; those that are no meshes or do not use the image are passed over.
        image: The image to look for in the materials.
        depsgraph: The evaluated dependency graph.
        all_faces: Where no material of any of the objects uses the image, take all faces of all of
            them, with the active render UV map.

    Raises:
        ValueError: The geometry is bad, such as NaN positions; the message names the object.
    """
    meshes = [obj for obj in objects if obj.type == "MESH"]
    found = ImageSurfaces()
    for obj in meshes:
        _add_object(found, obj, image, depsgraph, all_faces=False)
    if all_faces and not found.surfaces and not found.problems:
        for obj in meshes:
            _add_object(found, obj, image, depsgraph, all_faces=True)
    found.extensions = [name for name, _ in Counter(found.extensions).most_common()]
    found.problems = list(dict.fromkeys(found.problems))
    return found


def images_of_objects(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Image]:
    """Returns the images that the materials of objects show, each once."""
    found: dict[bpy.types.Image, None] = {}
    for obj in objects:
        for slot in obj.material_slots:
            if slot.material is not None:
                found.update(dict.fromkeys(images_of(slot.material)))
    return list(found)


def _add_object(
    found: ImageSurfaces,
    obj: bpy.types.Object,
    image: bpy.types.Image,
    depsgraph: bpy.types.Depsgraph,
    *,
    all_faces: bool,
) -> None:
    with _evaluated(obj, depsgraph) as (evaluated, mesh):
        slots = _slots_by_use(found, evaluated, mesh, image)
        if not slots and all_faces:
            slots = {_WHOLE_IMAGE: set(range(max(1, len(mesh.materials))))}
        if not slots:
            return
        if len(mesh.polygons) == 0:
            found.problems.append(f"object '{obj.name}' has no faces")
            return
        triangles = _read_triangles(evaluated, mesh)
        for use, materials in slots.items():
            layer = _uv_layer(mesh, use.uv_map)
            if layer is None:
                wanted = f"named '{use.uv_map}'" if use.uv_map else "at all"
                found.problems.append(f"object '{obj.name}' has no UV map {wanted}")
                continue
            chosen = np.isin(triangles.materials, list(materials))
            if not chosen.any():
                continue
            found.surfaces.append(_surface(obj.name, triangles, chosen, layer, use))
            found.extensions.append(use.extension)
            found.objects.append(obj.name)


@contextmanager
def _evaluated(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> Iterator[tuple[bpy.types.Object, bpy.types.Mesh]]:
    """Yields the evaluated object and its mesh.

    `to_mesh` is called plainly: with preserve_all_data_layers it ignores what edit mode changed.
    """
    evaluated = obj.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        yield evaluated, mesh
    finally:
        evaluated.to_mesh_clear()


def _slots_by_use(
    found: ImageSurfaces,
    evaluated: bpy.types.Object,
    mesh: bpy.types.Mesh,
    image: bpy.types.Image,
) -> dict[ImageUse, set[int]]:
    """Returns the material slots that sample the image, by the way in which they do."""
    slots: dict[ImageUse, set[int]] = {}
    for index, material in enumerate(_materials(evaluated, mesh)):
        if material is None:
            continue
        uses, warnings = image_uses(material.original, image)
        found.problems.extend(warnings)
        for use in uses:
            slots.setdefault(use, set()).add(index)
    return slots


def _materials(
    evaluated: bpy.types.Object, mesh: bpy.types.Mesh
) -> list[bpy.types.Material | None]:
    """Returns the material of each slot; a slot linked to the object overrides the mesh."""
    materials = list(mesh.materials)
    for index, slot in enumerate(evaluated.material_slots):
        if slot.link == "OBJECT" and index < len(materials):
            materials[index] = slot.material
    return materials


def _read_triangles(evaluated: bpy.types.Object, mesh: bpy.types.Mesh) -> _Triangles:
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    faces = np.empty(count, np.int32)
    mesh.loop_triangle_polygons.foreach_get("value", faces)

    corner_vertices = np.empty(len(mesh.loops), np.int32)
    mesh.attributes[".corner_vert"].data.foreach_get("value", corner_vertices)
    local = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", local)
    world = np.array(evaluated.matrix_world, np.float64)

    materials = np.zeros(len(mesh.polygons), np.int32)
    if "material_index" in mesh.attributes:
        mesh.attributes["material_index"].data.foreach_get("value", materials)
        np.clip(materials, 0, max(0, len(mesh.materials) - 1), out=materials)
    return _Triangles(
        positions=local.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3],
        corners=corners,
        vertices=corner_vertices[corners].reshape(-1, 3),
        materials=materials[faces],
    )


def _uv_layer(mesh: bpy.types.Mesh, name: str) -> bpy.types.MeshUVLoopLayer | None:
    if name:
        return mesh.uv_layers.get(name)
    return next((layer for layer in mesh.uv_layers if layer.active_render), None)


def _surface(
    object_name: str,
    triangles: _Triangles,
    chosen: NDArray[np.bool_],
    layer: bpy.types.MeshUVLoopLayer,
    use: ImageUse,
) -> prefilter.Surface:
    uvs = np.empty((len(layer.uv), 2), np.float32)
    layer.uv.foreach_get("vector", uvs.ravel())
    transform = np.array(use.transform)
    mapped = uvs[triangles.corners] @ transform[:, :2].T + transform[:, 2]
    try:
        return prefilter.Surface(
            triangles.positions, triangles.vertices[chosen], mapped.reshape(-1, 3, 2)[chosen]
        )
    except ValueError as error:
        raise ValueError(f"object '{object_name}': {error}") from error
