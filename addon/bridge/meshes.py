"""Evaluated meshes to `prefilter.Surface`: the part of each mesh that uses an image."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

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
    """The surfaces that an image is mapped on.

    Attributes:
        surfaces: One for each object, or mesh that is instanced, and each way in which its
            materials sample the image.
        objects: The name of the object that each surface comes from.
        uses: How each surface samples the image.
        extensions: What the Image Texture nodes do outside of the image, most common first.
        problems: What was left out and why.
        weighted: Whether some object has the importance that was asked for.
    """

    surfaces: list[prefilter.Surface] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    uses: list[ImageUse] = field(default_factory=list)
    extensions: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    weighted: bool = False

    def add_pose(self, other: "ImageSurfaces") -> None:
        """Adds what the same objects look like at another time.

        Surfaces that differ in space alone are joined: their areas are added, which to a filter is
        the same as keeping both.
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
    """What counts as an object's surface.

    Attributes:
        subdivision_limit: Take the limit surface of objects with a Catmull-Clark modifier on top.
        importance: The name of a vertex group or attribute that areas are multiplied by; empty for
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
    """Copies the faces that use an image, with the UVs that they use it with.

    Meshes are evaluated (modifiers, shape keys, edit mode) and in world space, so that the areas of
    different objects compare. What objects are instancers of counts with them: each instance with
    its own place in space.

    Args:
        objects: Objects; those that do not use the image are passed over.
        image: The image to look for in the materials.
        depsgraph: The evaluated dependency graph.
        options: What counts; `SurfaceOptions()` if None.
        all_faces: Where no material of any of the objects uses the image, take all faces of all of
            them, with the active render UV map.

    Raises:
        ValueError: The geometry is bad, such as NaN positions, and the message names the object; or
            no object has the importance that is asked for.
    """
    objects = list(objects)
    options = options or SurfaceOptions()
    found = _search(objects, image, depsgraph, options, all_faces=False)
    if all_faces and not found.surfaces and not found.problems:
        found = _search(objects, image, depsgraph, options, all_faces=True)
    if options.importance and found.surfaces and not found.weighted:
        names = ", ".join(f"'{name}'" for name in dict.fromkeys(found.objects))
        raise ValueError(
            f"importance: found no vertex group or attribute named '{options.importance}' "
            f"on {names}"
        )
    found.extensions = [name for name, _ in Counter(found.extensions).most_common()]
    found.problems = list(dict.fromkeys(found.problems))
    return found


def materials_of_objects(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Material]:
    """Returns the materials of objects and collections on them, each once."""
    found: dict[bpy.types.Material, None] = {}
    for obj in objects:
        collection = obj.instance_collection if obj.instance_type == "COLLECTION" else None
        for shown in (obj, *(collection.all_objects if collection is not None else ())):
            slots = shown.material_slots
            found.update((slot.material, None) for slot in slots if slot.material is not None)
    return list(found)


def images_of_objects(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Image]:
    """Returns the images that the materials of objects and collections on them show, each once."""
    shown = (image for material in materials_of_objects(objects) for image in images_of(material))
    return list(dict.fromkeys(shown))


def may_show_image(obj: bpy.types.Object) -> bool:
    """Returns whether an object is a mesh or an instance of a collection."""
    return obj.type == "MESH" or obj.instance_type == "COLLECTION"


def _search(
    objects: list[bpy.types.Object],
    image: bpy.types.Image,
    depsgraph: bpy.types.Depsgraph,
    options: SurfaceOptions,
    *,
    all_faces: bool,
) -> ImageSurfaces:
    reader = _Reader(image, depsgraph, options, all_faces=all_faces)
    instances = _Instances(objects, depsgraph)
    # Blender makes the objects of instanced geometry up while it walks over them. They go first:
    # reading the others may evaluate the graph anew.
    for pointer, instance in _walk(depsgraph) if instances.of_geometry else ():
        matrices = instances.of_geometry.pop((instance.parent.original, pointer), None)
        if matrices is not None:
            mesh = instance.object.data
            reader.read_mesh(instance.parent.name, mesh, list(mesh.materials), matrices)
    for obj in objects:
        if obj.type == "MESH" and (not obj.is_instancer or obj.show_instancer_for_viewport):
            matrix = np.array(obj.evaluated_get(depsgraph).matrix_world)
            reader.read_object(obj, [matrix], may_be_empty=obj in instances.parents)
    for obj, matrices in instances.of_objects:
        reader.read_object(obj, matrices)
    return reader.found


def _walk(
    depsgraph: bpy.types.Depsgraph,
) -> Iterator[tuple[int, bpy.types.DepsgraphObjectInstance]]:
    """Yields instances of meshes, with the address of the mesh; they last until the next one."""
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.object.type == "MESH":
            yield instance.object.data.as_pointer(), instance


def _may_have_instances(obj: bpy.types.Object) -> bool:
    return obj.is_instancer or any(modifier.type == "NODES" for modifier in obj.modifiers)


class _Instances:
    """What the objects are instancers of, and where.

    Attributes:
        of_geometry: Matrices by instancer and address of a mesh that no object has.
        of_objects: Objects, and the matrices that one instancer puts them at.
        parents: The instancers.
    """

    def __init__(self, objects: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> None:
        """Walks over the instances of a dependency graph."""
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
        self.of_objects = [(source, matrices) for (_, source), matrices in grouped.items()]
        self.parents = {parent for parent, _ in (*self.of_geometry, *grouped)}


class _Reader:
    """Reads meshes into surfaces."""

    def __init__(
        self,
        image: bpy.types.Image,
        depsgraph: bpy.types.Depsgraph,
        options: SurfaceOptions,
        *,
        all_faces: bool,
    ) -> None:
        """Starts with nothing found."""
        self.found = ImageSurfaces()
        self._image = image
        self._depsgraph = depsgraph
        self._options = options
        self._all_faces = all_faces

    def read_object(
        self, obj: bpy.types.Object, matrices: Matrices, *, may_be_empty: bool = False
    ) -> None:
        """Reads an object's evaluated mesh, or the limit surface of the mesh below its modifier."""
        modifier = None
        if self._options.subdivision_limit:
            modifier = subdivision.top_modifier(obj, self._depsgraph)
        if modifier is not None:
            evaluated = obj.evaluated_get(self._depsgraph)
            materials = _materials(evaluated, evaluated.data)
            if not self._all_faces and not self._slots_by_use(materials):
                return
            with (
                subdivision.without(obj, modifier, self._depsgraph) as is_without,
                _evaluated(obj, self._depsgraph) as (evaluated, mesh),
            ):
                rules = subdivision.Rules.of(modifier, mesh) if is_without else None
                if rules is not None:
                    materials = _materials(evaluated, mesh)
                    self.read_mesh(obj.name, mesh, materials, matrices, evaluated, rules)
                    return
        with _evaluated(obj, self._depsgraph) as (evaluated, mesh):
            materials = _materials(evaluated, mesh)
            if len(mesh.polygons) > 0 or not may_be_empty:
                self.read_mesh(obj.name, mesh, materials, matrices, evaluated)

    def read_mesh(
        self,
        name: str,
        mesh: bpy.types.Mesh,
        materials: list[bpy.types.Material | None],
        matrices: Matrices,
        evaluated: bpy.types.Object | None = None,
        rules: subdivision.Rules | None = None,
    ) -> None:
        """Reads a mesh that is alive now, placed by matrices.

        Args:
            name: Its object's.
            mesh: The mesh.
            materials: The material of each slot.
            matrices: Where it is, once or several times.
            evaluated: Its object, if it has one, for vertex groups.
            rules: How to make a limit surface of it, if at all.
        """
        slots = self._slots_by_use(materials)
        if not slots and self._all_faces:
            slots = {_WHOLE_IMAGE: set(range(max(1, len(materials))))}
        if not slots:
            return
        if len(mesh.polygons) == 0:
            self.found.problems.append(f"object '{name}' has no faces")
            return
        weights = None
        if self._options.importance:
            weights = attributes.read_weights(name, mesh, evaluated, self._options.importance)
            if weights is None:
                self.found.problems.append(
                    f"object '{name}' has no vertex group or attribute "
                    f"'{self._options.importance}'; all of it counts as 1"
                )
            else:
                self.found.weighted = True
        face_materials = attributes.face_materials(mesh, len(materials))
        for use, indices in slots.items():
            layer = _uv_layer(mesh, use.uv_map)
            if layer is None:
                wanted = f"named '{use.uv_map}'" if use.uv_map else "at all"
                self.found.problems.append(f"object '{name}' has no UV map {wanted}")
                continue
            chosen = np.isin(face_materials, list(indices))
            if not chosen.any():
                continue
            uvs = _mapped_uvs(layer, use)
            try:
                if rules is None:
                    surface = _plain_surface(mesh, chosen, uvs, weights)
                else:
                    surface = subdivision.limit_surface(mesh, chosen, uvs, weights, rules)
                self.found.surfaces.append(surface.placed(matrices))
            except ValueError as error:
                # What the library calls weights has another name here.
                message = re.sub("^weights", f"importance '{self._options.importance}'", str(error))
                raise ValueError(f"object '{name}': {message}") from error
            self.found.extensions.append(use.extension)
            self.found.objects.append(name)
            self.found.uses.append(use)

    def _slots_by_use(self, materials: list[bpy.types.Material | None]) -> dict[ImageUse, set[int]]:
        """Returns the material slots that sample the image, by the way in which they do."""
        slots: dict[ImageUse, set[int]] = {}
        for index, material in enumerate(materials):
            if material is None:
                continue
            uses, warnings = image_uses(material.original, self._image)
            self.found.problems.extend(warnings)
            for use in uses:
                slots.setdefault(use, set()).add(index)
        return slots


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
