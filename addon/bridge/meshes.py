# SPDX-License-Identifier: GPL-3.0-or-later

"""Surfaces of evaluated meshes: the faces of each mesh that use an image."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from . import attributes, subdivision
from .materials import ImageUse, image_uses, images_of

_WHOLE_IMAGE = ImageUse("", ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), "REPEAT")

Matrices = list[NDArray[np.float64]]


@dataclass
class ImageSurfaces:
    """Surfaces that an image is mapped on.

    Attributes:
        surfaces: One per object, or instanced mesh, and per way in which its materials sample the
            image.
        objects: Name of the object of each surface.
        uses: How each surface samples the image.
        extensions: Extensions of the Image Texture nodes, most common first.
        problems: Descriptions of omitted parts, with reasons.
        weighted: Whether any object has the importance attribute.
    """

    surfaces: list[prefilter.Surface] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    uses: list[ImageUse] = field(default_factory=list)
    extensions: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    weighted: bool = False

    def add_pose(self, other: "ImageSurfaces") -> None:
        """Adds the surfaces of the same objects at another time.

        Surfaces that differ only in vertex positions are merged by adding their areas, which is the
        same to a filter as both surfaces.
        """
        for surface, name, use in zip(other.surfaces, other.objects, other.uses, strict=True):
            for i, known in enumerate(zip(self.objects, self.uses, strict=True)):
                if known == (name, use):
                    joined = prefilter.Surface.merged([self.surfaces[i], surface])
                    if len(joined) == 1:
                        self.surfaces[i] = joined[0]
                        break
            else:
                self.surfaces.append(surface)
                self.objects.append(name)
                self.uses.append(use)
        self.extensions = list(dict.fromkeys(self.extensions + other.extensions))
        self.problems = list(dict.fromkeys(self.problems + other.problems))
        self.weighted = self.weighted or other.weighted


@dataclass(frozen=True)
class SurfaceOptions:
    """Options for reading surfaces.

    Attributes:
        subdivision_limit: Whether to use the limit surface of objects with a Catmull-Clark modifier
            at the end.
        importance: Name of a vertex group or attribute by which areas are multiplied; empty for
            none.
    """

    subdivision_limit: bool = True
    importance: str = ""


def image_surfaces(
    objects: Iterable[bpy.types.Object],
    image: bpy.types.Image,
    depsgraph: bpy.types.Depsgraph,
    options: SurfaceOptions | None = None,
    *,
    all_faces: bool = False,
) -> ImageSurfaces:
    """Copies the faces that use an image, with their UVs for it.

    Meshes are evaluated (modifiers, shape keys, Edit Mode) and in world space, so that areas of
    different objects are comparable. Instances belong to their instancer, each with its own
    transform.

    Args:
        objects: Objects; those that do not use the image are skipped.
        image: The image to look for in the materials.
        depsgraph: The evaluated dependency graph.
        options: Options; `SurfaceOptions()` if None.
        all_faces: Whether to use all faces, with the active render UV map, if no material of any
            object uses the image.

    Raises:
        ValueError: The geometry is invalid, such as NaN positions (the message names the object),
            or no object has the importance attribute.
    """
    objects = list(objects)
    options = options or SurfaceOptions()
    surfaces = _search_one(objects, image, depsgraph, options, all_faces=False)
    if all_faces and not surfaces.surfaces and not surfaces.problems:
        surfaces = _search_one(objects, image, depsgraph, options, all_faces=True)
    if options.importance and surfaces.surfaces and not surfaces.weighted:
        names = ", ".join(f"'{name}'" for name in dict.fromkeys(surfaces.objects))
        raise ValueError(
            f"Importance: found no vertex group or attribute named '{options.importance}' "
            f"on {names}"
        )
    return surfaces


def surfaces_of_images(
    users: Mapping[bpy.types.Image, Iterable[bpy.types.Object]],
    depsgraph: bpy.types.Depsgraph,
) -> dict[bpy.types.Image, ImageSurfaces | ValueError]:
    """Returns `image_surfaces` of several images, but reads every mesh only once.

    Images that sample the same faces in the same way share their surfaces.

    Args:
        users: The objects of each image.
        depsgraph: The evaluated dependency graph.

    Returns:
        The surfaces of each image, or the error in reading them.
    """
    return _search(users, depsgraph, SurfaceOptions(), all_faces=False)


def materials_of_objects(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Material]:
    """Returns the materials of objects and of the collections that they instance, each once."""
    materials: dict[bpy.types.Material, None] = {}
    for obj in objects:
        collection = obj.instance_collection if obj.instance_type == "COLLECTION" else None
        for shown in (obj, *(collection.all_objects if collection is not None else ())):
            slots = shown.material_slots
            materials.update((slot.material, None) for slot in slots if slot.material is not None)
    return list(materials)


def images_of_objects(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Image]:
    """Returns the images in `materials_of_objects`, each once."""
    shown = (image for material in materials_of_objects(objects) for image in images_of(material))
    return list(dict.fromkeys(shown))


def may_show_image(obj: bpy.types.Object) -> bool:
    """Whether an object is a mesh or an instance of a collection."""
    return obj.type == "MESH" or obj.instance_type == "COLLECTION"


def _search_one(
    objects: list[bpy.types.Object],
    image: bpy.types.Image,
    depsgraph: bpy.types.Depsgraph,
    options: SurfaceOptions,
    *,
    all_faces: bool,
) -> ImageSurfaces:
    surfaces = _search({image: objects}, depsgraph, options, all_faces=all_faces)[image]
    if isinstance(surfaces, ValueError):
        raise surfaces
    return surfaces


def _search(
    users: Mapping[bpy.types.Image, Iterable[bpy.types.Object]],
    depsgraph: bpy.types.Depsgraph,
    options: SurfaceOptions,
    *,
    all_faces: bool,
) -> dict[bpy.types.Image, ImageSurfaces | ValueError]:
    reader = _Reader(users, depsgraph, options, all_faces=all_faces)
    images: dict[bpy.types.Object, list[bpy.types.Image]] = defaultdict(list)
    for image, objects in users.items():
        for obj in objects:
            images[obj].append(image)
    instances = _Instances(list(images), depsgraph)
    # The objects of instanced geometry exist only during the iteration. They are read first, as
    # reading others may reevaluate the graph.
    for pointer, instance in _walk(depsgraph) if instances.of_geometry else ():
        parent = instance.parent.original
        matrices = instances.of_geometry.pop((parent, pointer), None)
        if matrices is not None:
            mesh = instance.object.data
            materials = list(mesh.materials)
            reader.read_mesh(instance.parent.name, mesh, materials, matrices, images[parent])
    for obj, chosen in images.items():
        if obj.type == "MESH" and (not obj.is_instancer or obj.show_instancer_for_viewport):
            matrix = np.array(obj.evaluated_get(depsgraph).matrix_world)
            reader.read_object(obj, [matrix], chosen, may_be_empty=obj in instances.parents)
    for parent, obj, matrices in instances.of_objects:
        reader.read_object(obj, matrices, images[parent])
    return reader.result()


def _walk(
    depsgraph: bpy.types.Depsgraph,
) -> Iterator[tuple[int, bpy.types.DepsgraphObjectInstance]]:
    """Yields instances of meshes, valid until the next one, with the address of the mesh."""
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.object.type == "MESH":
            yield instance.object.data.as_pointer(), instance


def _may_have_instances(obj: bpy.types.Object) -> bool:
    return obj.is_instancer or any(modifier.type == "NODES" for modifier in obj.modifiers)


class _Instances:
    """Instances of objects and of geometry, with their matrices.

    Attributes:
        of_geometry: Matrices by instancer and address of a mesh without an object.
        of_objects: Instancers, instanced objects, and the matrices of the instances.
        parents: The instancers.
    """

    def __init__(self, objects: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> None:
        """Collects the instances of a dependency graph."""
        self.of_geometry: dict[tuple[bpy.types.Object, int], Matrices] = defaultdict(list)
        grouped: dict[tuple[bpy.types.Object, bpy.types.Object], Matrices] = defaultdict(list)
        chosen = {obj for obj in objects if _may_have_instances(obj)}
        for pointer, instance in _walk(depsgraph) if chosen else ():
            parent = instance.parent.original
            if parent not in chosen:
                continue
            matrix = np.array(instance.matrix_world)
            source = instance.instance_object.original
            if source == parent:
                self.of_geometry[parent, pointer].append(matrix)
            else:
                grouped[parent, source].append(matrix)
        self.of_objects = [(*pair, matrices) for pair, matrices in grouped.items()]
        self.parents = {parent for parent, _ in (*self.of_geometry, *grouped)}


class _Reader:
    """Reads meshes into surfaces, for several images at once."""

    def __init__(
        self,
        images: Iterable[bpy.types.Image],
        depsgraph: bpy.types.Depsgraph,
        options: SurfaceOptions,
        *,
        all_faces: bool,
    ) -> None:
        """Starts without surfaces."""
        self._surfaces = {image: ImageSurfaces() for image in images}
        self._failures: dict[bpy.types.Image, ValueError] = {}
        self._depsgraph = depsgraph
        self._options = options
        self._all_faces = all_faces

    def result(self) -> dict[bpy.types.Image, ImageSurfaces | ValueError]:
        """Returns the surfaces of each image, or the error in reading them."""
        for surfaces in self._surfaces.values():
            surfaces.extensions = [name for name, _ in Counter(surfaces.extensions).most_common()]
            surfaces.problems = list(dict.fromkeys(surfaces.problems))
        return {**self._surfaces, **self._failures}

    def read_object(
        self,
        obj: bpy.types.Object,
        matrices: Matrices,
        images: list[bpy.types.Image],
        *,
        may_be_empty: bool = False,
    ) -> None:
        """Reads an object's evaluated mesh, or the limit surface of the mesh below its modifier."""
        modifier = None
        if self._options.subdivision_limit:
            modifier = subdivision.top_modifier(obj, self._depsgraph)
        if modifier is not None:
            evaluated = obj.evaluated_get(self._depsgraph)
            materials = _materials(evaluated, evaluated.data)
            if not self._all_faces:
                images = [image for image in images if self._slots_by_use(image, materials)]
                if not images:
                    return
            with (
                subdivision.without(obj, modifier, self._depsgraph) as is_without,
                _evaluated(obj, self._depsgraph) as (evaluated, mesh),
            ):
                rules = subdivision.Rules.of(modifier, mesh) if is_without else None
                if rules is not None:
                    materials = _materials(evaluated, mesh)
                    self.read_mesh(obj.name, mesh, materials, matrices, images, evaluated, rules)
                    return
        with _evaluated(obj, self._depsgraph) as (evaluated, mesh):
            materials = _materials(evaluated, mesh)
            if len(mesh.polygons) > 0 or not may_be_empty:
                self.read_mesh(obj.name, mesh, materials, matrices, images, evaluated)

    def read_mesh(
        self,
        name: str,
        mesh: bpy.types.Mesh,
        materials: list[bpy.types.Material | None],
        matrices: Matrices,
        images: list[bpy.types.Image],
        evaluated: bpy.types.Object | None = None,
        rules: subdivision.Rules | None = None,
    ) -> None:
        """Reads instances of a mesh.

        Args:
            name: Name of its object.
            mesh: The mesh, which is valid during the call.
            materials: The material of each slot.
            matrices: World matrices of its instances.
            images: Images that it may use.
            evaluated: Its object, if it has one, for vertex groups.
            rules: Rules for its limit surface; None for the mesh itself.
        """
        mesh_surfaces = _MeshSurfaces(
            name, mesh, len(materials), matrices, evaluated, rules, self._options
        )
        for image in images:
            if image in self._failures:
                continue
            slots = self._slots_by_use(image, materials)
            if not slots and self._all_faces:
                slots = {_WHOLE_IMAGE: set(range(max(1, len(materials))))}
            if slots:
                try:
                    mesh_surfaces.add(slots, self._surfaces[image])
                except ValueError as error:
                    self._failures[image] = error

    def _slots_by_use(
        self, image: bpy.types.Image, materials: list[bpy.types.Material | None]
    ) -> dict[ImageUse, set[int]]:
        """Material slots that sample an image, by use."""
        slots: dict[ImageUse, set[int]] = {}
        for index, material in enumerate(materials):
            if material is None:
                continue
            uses, warnings = image_uses(material.original, image)
            self._surfaces[image].problems.extend(warnings)
            for use in uses:
                slots.setdefault(use, set()).add(index)
        return slots


class _MeshSurfaces:
    """A mesh, and the surfaces already made of it."""

    def __init__(
        self,
        name: str,
        mesh: bpy.types.Mesh,
        slot_count: int,
        matrices: Matrices,
        evaluated: bpy.types.Object | None,
        rules: subdivision.Rules | None,
        options: SurfaceOptions,
    ) -> None:
        """Keeps the arguments of `_Reader.read_mesh`."""
        self._name = name
        self._mesh = mesh
        self._slot_count = slot_count
        self._matrices = matrices
        self._evaluated = evaluated
        self._rules = rules
        self._options = options
        self._surfaces: dict[object, prefilter.Surface | None] = {}

    def add(self, slots: dict[ImageUse, set[int]], result: ImageSurfaces) -> None:
        """Adds the surfaces of the faces that sample an image.

        Raises:
            ValueError: The geometry is invalid.
        """
        if len(self._mesh.polygons) == 0:
            result.problems.append(f"object '{self._name}' has no faces")
            return
        if self._options.importance:
            if self._weights is None:
                result.problems.append(
                    f"object '{self._name}' has no vertex group or attribute "
                    f"'{self._options.importance}'; all of it counts as 1"
                )
            else:
                result.weighted = True
        for use, indices in slots.items():
            layer = _uv_layer(self._mesh, use.uv_map)
            if layer is None:
                name = f"named '{use.uv_map}'" if use.uv_map else "at all"
                result.problems.append(f"object '{self._name}' has no UV map {name}")
                continue
            key = layer.name, use.transform, frozenset(indices)
            if key not in self._surfaces:
                self._surfaces[key] = self._surface(layer, use, indices)
            surface = self._surfaces[key]
            if surface is not None:
                result.surfaces.append(surface)
                result.extensions.append(use.extension)
                result.objects.append(self._name)
                result.uses.append(use)

    @cached_property
    def _weights(self) -> attributes.Weights | None:
        importance = self._options.importance
        if not importance:
            return None
        return attributes.read_weights(self._name, self._mesh, self._evaluated, importance)

    @cached_property
    def _face_materials(self) -> NDArray[np.int32]:
        return attributes.face_materials(self._mesh, self._slot_count)

    def _surface(
        self, layer: bpy.types.MeshUVLoopLayer, use: ImageUse, indices: set[int]
    ) -> prefilter.Surface | None:
        chosen = np.isin(self._face_materials, list(indices))
        if not chosen.any():
            return None
        uvs = _mapped_uvs(layer, use)
        try:
            if self._rules is None:
                surface = _plain_surface(self._mesh, chosen, uvs, self._weights)
            else:
                surface = subdivision.limit_surface(
                    self._mesh, chosen, uvs, self._weights, self._rules
                )
            return surface.placed(self._matrices)
        except ValueError as error:
            # The library's weights are called importance here.
            message = re.sub("^weights", f"importance '{self._options.importance}'", str(error))
            raise ValueError(f"object '{self._name}': {message}") from error


@contextmanager
def _evaluated(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> Iterator[tuple[bpy.types.Object, bpy.types.Mesh]]:
    """Yields the evaluated object and its mesh.

    `to_mesh` is called without preserve_all_data_layers, which would ignore changes in Edit Mode.
    """
    evaluated = obj.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        yield evaluated, mesh
    finally:
        evaluated.to_mesh_clear()


def _materials(
    evaluated: bpy.types.Object, mesh: bpy.types.Mesh
) -> list[bpy.types.Material | None]:
    """Returns the material of each slot; a slot linked to the object overrides the mesh."""
    materials = list(mesh.materials)
    for index, slot in enumerate(evaluated.material_slots):
        if slot.link == "OBJECT" and index < len(materials):
            materials[index] = slot.material
    return materials


def _uv_layer(mesh: bpy.types.Mesh, name: str) -> bpy.types.MeshUVLoopLayer | None:
    if name:
        return mesh.uv_layers.get(name)
    return next((layer for layer in mesh.uv_layers if layer.active_render), None)


def _mapped_uvs(layer: bpy.types.MeshUVLoopLayer, use: ImageUse) -> NDArray[np.float64]:
    uvs = np.empty((len(layer.uv), 2), np.float32)
    layer.uv.foreach_get("vector", uvs.ravel())
    transform = np.array(use.transform)
    return uvs @ transform[:, :2].T + transform[:, 2]


def _plain_surface(
    mesh: bpy.types.Mesh,
    chosen: NDArray[np.bool_],
    uvs: NDArray[np.float64],
    weights: attributes.Weights | None,
) -> prefilter.Surface:
    corners, faces = attributes.corner_triangles(mesh)
    corners = corners[chosen[faces]]
    importance = None
    if weights is not None:
        importance = weights.values
        if weights.domain == "FACE":
            importance = importance[faces[chosen[faces]]][:, None]
        elif weights.domain == "CORNER":
            importance = importance[corners]
    return prefilter.Surface(
        attributes.positions(mesh),
        attributes.corner_vertices(mesh)[corners],
        uvs[corners],
        weights=importance,
    )
