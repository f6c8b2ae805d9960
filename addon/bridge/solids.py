# SPDX-License-Identifier: GPL-3.0-or-later

"""Evaluated objects to triangles in space: what a solid is made of, with its materials and layers.

Positions are in the axes and units of the world, from an origin that is near, so that objects far
away keep their precision.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import attributes
from .layers import COLOR, UV_MAP, Layer, Triangles, Wanted, read_layers, unread
from .marks import MarkKind, Marks, read_marks

FloatArray = NDArray[np.float64]
Positions = NDArray[np.floating]

_ROWS = 1 << 18
_NEAR = 8.0
"""How many times its extent a mesh may be away from the origin, for single precision."""

SOLID_TYPES = frozenset({"MESH", "CURVE", "SURFACE", "FONT", "META"})
"""Types of objects that evaluate to a mesh."""


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
        positions: (n, 3), float32 where that is precise enough, else float64.
        triangles: (m, 3) int32; counter-clockwise from outside, mirrored or not.
        materials: (m,) int32, indices in the materials of the solid; or (1,) for one of all.
        layers: Its attributes.
        faces: (m,) int32, the face that each triangle is cut from; None if all are triangles.
        is_own: Whether it is the mesh of the object itself, and no instance.
    """

    positions: Positions
    triangles: NDArray[np.int32]
    materials: NDArray[np.int32]
    layers: list[Layer]
    faces: NDArray[np.int32] | None = None
    is_own: bool = False


@dataclass
class Solid:
    """What an object shows: its mesh and its instances.

    Attributes:
        name: The object's.
        parts: Its meshes, in space.
        materials: Those of the object's slots, in their order, then those of its instances.
        active: By kind, the names of the active color attribute and UV map.
        rendered: Likewise of those that renders use.
        marks: Seams, and weights and other attributes of edges and vertices, in space.
        left_out: The names of attributes of other types.
        locked_groups: The vertex groups whose weights are locked.
        kept_modifiers: Those of its modifiers that it does not show.
    """

    name: str
    parts: list[Part] = field(default_factory=list)
    materials: list[MaterialKey | None] = field(default_factory=list)
    active: dict[str, str] = field(default_factory=dict)
    rendered: dict[str, str] = field(default_factory=dict)
    marks: list[Marks] = field(default_factory=list)
    left_out: set[str] = field(default_factory=set)
    locked_groups: set[str] = field(default_factory=set)
    kept_modifiers: set[str] = field(default_factory=set)


def frame_origin(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> FloatArray:
    """Returns where an object is, as the origin of positions."""
    return np.array(obj.evaluated_get(depsgraph).matrix_world.translation, np.float64)


def read_solids(
    objects: Iterable[bpy.types.Object],
    depsgraph: bpy.types.Depsgraph,
    origins: Iterable[FloatArray],
    wanted: Wanted,
) -> list[Solid]:
    """Copies what objects show, with modifiers, shape keys and instances.

    Args:
        objects: Objects, each once.
        depsgraph: The evaluated dependency graph.
        origins: For each object, what its positions are relative to.
        wanted: Which layers to read.

    Raises:
        ValueError: A coordinate is not finite; the message names the object.
    """
    objects = list(objects)
    readers = {
        obj: _Reader(Solid(obj.name), origin, wanted)
        for obj, origin in zip(objects, origins, strict=True)
    }
    for obj, reader in readers.items():
        evaluated = obj.evaluated_get(depsgraph)
        solid = reader.solid
        solid.locked_groups.update(one.name for one in obj.vertex_groups if one.lock_weight)
        # The details of Multires are the mesh's own.
        solid.kept_modifiers.update(
            one.name for one in obj.modifiers if not one.show_viewport and one.type != "MULTIRES"
        )
        for slot in evaluated.material_slots:
            solid.materials.append(MaterialKey.of(slot.material))
        if obj.type == "MESH" and (not obj.is_instancer or obj.show_instancer_for_viewport):
            matrix = np.array(evaluated.matrix_world, np.float64)
            reader.read(evaluated, matrix, is_own=True)
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
    layers: list[Layer]
    marks: list[tuple[MarkKind, NDArray[np.int32], NDArray[Any]]]
    faces: NDArray[np.int32] | None


class _Reader:
    """Reads the meshes of one solid; a mesh that is placed often is read once."""

    def __init__(self, solid: Solid, origin: FloatArray, wanted: Wanted) -> None:
        """Starts without parts."""
        self.solid = solid
        self._origin = origin
        self._wanted = wanted
        self._known: dict[int, _LocalMesh] = {}

    def read(
        self,
        shown: bpy.types.Object,
        matrix: FloatArray,
        *,
        is_own: bool = False,
        is_made_up: bool = False,
    ) -> None:
        """Adds the mesh that an evaluated object shows, at a matrix.

        Args:
            shown: The object.
            matrix: Where it is.
            is_own: Whether it is that of the solid itself.
            is_made_up: Whether Blender made the object up for a mesh that no object has.
        """
        if len(shown.data.polygons) == 0:
            return
        key = shown.data.as_pointer()
        if key not in self._known:
            self._known[key] = self._copied(shown, shown.data, is_made_up=is_made_up)
        local = self._known[key]
        linear = matrix[:3, :3]
        positions = _placed(local.positions, linear, matrix[:3, 3] - self._origin)
        triangles = local.triangles
        layers = [layer.rotated(linear) for layer in local.layers]
        if np.linalg.det(linear) < 0:
            triangles = triangles[:, ::-1]
            layers = [layer.turned() for layer in layers]
        # An object's own slots are the first ones, as many as they are.
        if is_own:
            found = list(range(len(local.slots)))
        else:
            found = [self._slot(key) for key in local.slots]
        slots = np.array(found or [self._slot(None)], np.int32)
        for kind, ends, values in local.marks:
            self.solid.marks.append(Marks(kind, positions[ends], values))
        materials = slots[local.face_materials]
        self.solid.parts.append(
            Part(positions, triangles, materials, layers, local.faces if is_own else None, is_own)
        )

    def _slot(self, key: MaterialKey | None) -> int:
        if key not in self.solid.materials:
            self.solid.materials.append(key)
        return self.solid.materials.index(key)

    def _copied(
        self, shown: bpy.types.Object, mesh: bpy.types.Mesh, *, is_made_up: bool
    ) -> _LocalMesh:
        positions = attributes.positions(mesh)
        self._check_finite(positions)
        corners = faces = None
        triangles = attributes.corner_vertices(mesh)
        if attributes.is_triangulated(mesh):
            triangles = triangles.reshape(-1, 3)
        else:
            corners, faces = attributes.corner_triangles(mesh)
            triangles = triangles[corners]
        if is_made_up:
            slots = [MaterialKey.of(material) for material in mesh.materials]
        else:
            slots = [MaterialKey.of(slot.material) for slot in shown.material_slots]
        materials = attributes.face_materials(mesh, len(slots))
        if not (materials != materials[0]).any():
            materials = materials[:1]
        elif faces is not None:
            materials = materials[faces]
        layers = list(read_layers(shown, mesh, Triangles(triangles, corners, faces), self._wanted))
        marks = []
        if self._wanted.attributes:
            marks = list(read_marks(mesh))
            self.solid.left_out |= unread(mesh)
        self._note_active(mesh)
        return _LocalMesh(positions, triangles, materials, slots, layers, marks, faces)

    def _check_finite(self, positions: NDArray[np.float32]) -> None:
        # Sums in double precision do not overflow, and hold no memory.
        if np.isfinite(positions.sum(dtype=np.float64)):
            return
        broken = np.flatnonzero(~np.isfinite(positions).all(axis=1))
        raise ValueError(
            f"object '{self.solid.name}': vertex {broken[0]} is at "
            f"{tuple(positions[broken[0]].tolist())}; coordinates must be finite"
        )

    def _note_active(self, mesh: bpy.types.Mesh) -> None:
        colors, maps = mesh.color_attributes, mesh.uv_layers
        found = {COLOR: colors.active_color_name or "", UV_MAP: maps.active.name if maps else ""}
        for kind, name in found.items():
            if name:
                self.solid.active.setdefault(kind, name)
        default = colors.render_color_index
        if 0 <= default < len(colors):
            self.solid.rendered.setdefault(COLOR, colors[default].name)
        rendered = next((layer.name for layer in maps if layer.active_render), "")
        if rendered:
            self.solid.rendered.setdefault(UV_MAP, rendered)


def _placed(positions: NDArray[np.float32], linear: FloatArray, offset: FloatArray) -> Positions:
    """Returns where points are; in double precision only where they are far from the origin."""
    if np.array_equal(linear, np.eye(3)) and not offset.any():
        return positions
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    placed: Positions = np.empty_like(positions)
    for start in range(0, len(positions), _ROWS):
        some = positions[start : start + _ROWS].astype(np.float64) @ linear.T + offset
        placed[start : start + _ROWS] = some
        low, high = np.minimum(low, some.min(axis=0)), np.maximum(high, some.max(axis=0))
    if np.abs([low, high]).max() <= _NEAR * (high - low).max():
        return placed
    return np.asarray(positions.astype(np.float64) @ linear.T + offset)
