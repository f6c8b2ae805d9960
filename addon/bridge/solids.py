"""Evaluated objects to triangles in space: what a solid is made of, with its materials and colours.

Positions are in the axes and units of the world, from an origin that is near, so that objects far
away keep their precision.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from . import attributes

FloatArray = NDArray[np.float64]

SOLID_TYPES = frozenset({"MESH", "CURVE", "SURFACE", "FONT", "META"})
"""Types of objects that evaluate to a mesh."""


@dataclass(frozen=True)
class Colors:
    """A colour attribute of a mesh.

    Attributes:
        data_type: FLOAT_COLOR or BYTE_COLOR.
        values: (k, 4) float32, scene-linear.
        corners: (m, 3) int32, which of them the corners of the triangles have.
    """

    data_type: str
    values: NDArray[np.float32]
    corners: NDArray[np.int32]


@dataclass(frozen=True)
class MaterialKey:
    """What a material is found by again, after an undo too."""

    name: str
    library: str | None

    @classmethod
    def of(cls, material: bpy.types.Material | None) -> "MaterialKey | None":
        """Returns the key of a material slot's content."""
        if material is None:
            return None
        material = material.original
        return cls(material.name, material.library.filepath if material.library else None)

    def find(self) -> bpy.types.Material | None:
        """Returns the material, or None where it is gone."""
        return bpy.data.materials.get((self.name, self.library))


@dataclass(frozen=True)
class Part:
    """A mesh, placed once.

    Attributes:
        positions: (n, 3) float64.
        triangles: (m, 3) int32; counter-clockwise from outside, mirrored or not.
        materials: (m,) int32, indices in the materials of the solid.
        colors: Its colour attributes.
    """

    positions: FloatArray
    triangles: NDArray[np.int32]
    materials: NDArray[np.int32]
    colors: dict[str, Colors]


@dataclass
class Solid:
    """What an object shows: its mesh and its instances.

    Attributes:
        name: The object's.
        parts: Its meshes, in space.
        materials: Those of the object's slots, in their order, then those of its instances.
        active_color: The name of the active colour attribute; empty for none.
        render_color: The name of the one that renders use.
    """

    name: str
    parts: list[Part] = field(default_factory=list)
    materials: list[MaterialKey | None] = field(default_factory=list)
    active_color: str = ""
    render_color: str = ""


def frame_origin(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> FloatArray:
    """Returns where an object is, as the origin of positions."""
    return np.array(obj.evaluated_get(depsgraph).matrix_world.translation, np.float64)


def read_solids(
    objects: Iterable[bpy.types.Object],
    depsgraph: bpy.types.Depsgraph,
    origins: Iterable[FloatArray],
) -> list[Solid]:
    """Copies what objects show, with modifiers, shape keys and instances.

    Args:
        objects: Objects, each once.
        depsgraph: The evaluated dependency graph.
        origins: For each object, what its positions are relative to.

    Raises:
        ValueError: A coordinate is not finite; the message names the object.
    """
    objects = list(objects)
    readers = {
        obj: _Reader(Solid(obj.name), origin) for obj, origin in zip(objects, origins, strict=True)
    }
    for obj, reader in readers.items():
        evaluated = obj.evaluated_get(depsgraph)
        for slot in evaluated.material_slots:
            reader.solid.materials.append(MaterialKey.of(slot.material))
        if obj.type == "MESH" and (not obj.is_instancer or obj.show_instancer_for_viewport):
            reader.read(evaluated, np.array(evaluated.matrix_world, np.float64))
    chosen = {obj for obj in objects if _is_seen_as_instances(obj)}
    for instance in depsgraph.object_instances if chosen else ():
        if not instance.is_instance or instance.object.type != "MESH":
            continue
        parent = instance.parent.original
        if parent in readers:
            matrix = np.array(instance.matrix_world, np.float64)
            is_made_up = instance.instance_object.original == parent
            readers[parent].read(instance.object, matrix, is_made_up=is_made_up)
    return [reader.solid for reader in readers.values()]


def _is_seen_as_instances(obj: bpy.types.Object) -> bool:
    """Returns whether all or a part of an object comes as instances.

    The meshes that curves, texts and metaballs evaluate to do, too.
    """
    return (
        obj.type != "MESH"
        or obj.is_instancer
        or any(modifier.type in {"NODES", "PARTICLE_SYSTEM"} for modifier in obj.modifiers)
    )


@dataclass(frozen=True)
class _LocalMesh:
    """A mesh in its own space, with the materials of its slots."""

    positions: NDArray[np.float32]
    triangles: NDArray[np.int32]
    face_materials: NDArray[np.int32]
    slots: list[MaterialKey | None]
    colors: dict[str, Colors]


class _Reader:
    """Reads the meshes of one solid; a mesh that is placed often is read once."""

    def __init__(self, solid: Solid, origin: FloatArray) -> None:
        """Starts without parts."""
        self.solid = solid
        self._origin = origin
        self._known: dict[int, _LocalMesh] = {}

    def read(
        self, shown: bpy.types.Object, matrix: FloatArray, *, is_made_up: bool = False
    ) -> None:
        """Adds the mesh that an evaluated object shows, at a matrix.

        Args:
            shown: The object.
            matrix: Where it is.
            is_made_up: Whether Blender made the object up for a mesh that no object has.
        """
        if len(shown.data.polygons) == 0:
            return
        key = shown.data.as_pointer()
        if key not in self._known:
            self._known[key] = self._copied(shown, shown.data, is_made_up=is_made_up)
        local = self._known[key]
        linear = matrix[:3, :3]
        positions = local.positions.astype(np.float64) @ linear.T
        positions += matrix[:3, 3] - self._origin
        triangles = local.triangles
        colors = local.colors
        if np.linalg.det(linear) < 0:
            triangles = triangles[:, ::-1]
            colors = {
                name: Colors(color.data_type, color.values, color.corners[:, ::-1])
                for name, color in colors.items()
            }
        slots = np.array([self._slot(key) for key in local.slots] or [self._slot(None)], np.int32)
        self.solid.parts.append(Part(positions, triangles, slots[local.face_materials], colors))

    def _slot(self, key: MaterialKey | None) -> int:
        if key not in self.solid.materials:
            self.solid.materials.append(key)
        return self.solid.materials.index(key)

    def _copied(
        self, shown: bpy.types.Object, mesh: bpy.types.Mesh, *, is_made_up: bool
    ) -> _LocalMesh:
        positions = attributes.positions(mesh)
        broken = np.flatnonzero(~np.isfinite(positions).all(axis=1))
        if len(broken):
            raise ValueError(
                f"object '{self.solid.name}': vertex {broken[0]} is at "
                f"{tuple(positions[broken[0]].tolist())}; coordinates must be finite"
            )
        corners, faces = attributes.corner_triangles(mesh)
        if is_made_up:
            slots = [MaterialKey.of(material) for material in mesh.materials]
        else:
            slots = [MaterialKey.of(slot.material) for slot in shown.material_slots]
        face_materials = attributes.face_materials(mesh, len(slots))
        triangles = attributes.corner_vertices(mesh)[corners]
        colors = {}
        for attribute in mesh.color_attributes:
            values = np.empty((len(attribute.data), 4), np.float32)
            attribute.data.foreach_get("color", values.ravel())
            indices = triangles if attribute.domain == "POINT" else corners
            colors[attribute.name] = Colors(attribute.data_type, values, indices)
        self.solid.active_color = self.solid.active_color or (
            mesh.color_attributes.active_color_name or ""
        )
        default = mesh.color_attributes.render_color_index
        if not self.solid.render_color and 0 <= default < len(mesh.color_attributes):
            self.solid.render_color = mesh.color_attributes[default].name
        return _LocalMesh(positions, triangles, face_materials[faces], slots, colors)
