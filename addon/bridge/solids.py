# SPDX-License-Identifier: GPL-3.0-or-later

"""Triangles of evaluated objects, with materials and layers.

Positions are in the axes and units of the world, relative to a nearby origin, so that distant
objects keep their precision.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import attributes
from .layers import COLOR, UV_MAP, Layer, LayerSelection, Triangles, read_layers, unread
from .marks import MarkKind, Marks, read_marks

FloatArray = NDArray[np.float64]
Positions = NDArray[np.floating]

_ROWS = 1 << 18
_MAX_DISTANCE_FOR_SINGLE = 8.0
"""Greatest distance from the origin, in extents of the mesh, that uses single precision."""

SOLID_TYPES = frozenset({"MESH", "CURVE", "SURFACE", "FONT", "META"})
"""Types of objects that evaluate to a mesh."""


@dataclass(frozen=True)
class MaterialKey:
    """Name and library of a material, to find it again even after an undo."""

    name: str
    library: str | None

    @classmethod
    def of(cls, material: bpy.types.Material | None) -> "MaterialKey | None":
        """Returns the key of a material, None for an empty slot."""
        if material is None:
            return None
        material = material.original
        return cls(material.name, material.library.filepath if material.library else None)

    def find(self) -> bpy.types.Material | None:
        """Returns the material; None if it is gone."""
        return bpy.data.materials.get((self.name, self.library))


@dataclass(frozen=True)
class Part:
    """One instance of a mesh.

    Attributes:
        positions: (n, 3), float32 if that is precise enough, else float64.
        triangles: (m, 3) int32; counter-clockwise from outside, even where mirrored.
        materials: (m,) int32, indices of the solid's materials, or (1,) if all are the same.
        layers: Its attributes.
        faces: (m,) int32, face of each triangle; None if all faces are triangles.
        is_own: Whether it is the mesh of the object itself, not of an instance.
    """

    positions: Positions
    triangles: NDArray[np.int32]
    materials: NDArray[np.int32]
    layers: list[Layer]
    faces: NDArray[np.int32] | None = None
    is_own: bool = False


@dataclass
class Solid:
    """The evaluated meshes of an object and its instances.

    Attributes:
        name: Name of the object.
        parts: Its meshes, transformed.
        materials: Materials of the object's slots in their order, then of its instances.
        active: Names of the active color attribute and UV map, by kind.
        rendered: Names of the color attribute and UV map used by renders, by kind.
        marks: Seams, weights and other attributes of edges and vertices, with their positions.
        left_out: Names of attributes whose types cannot be transferred.
        locked_groups: Names of vertex groups with locked weights.
        kept_modifiers: Names of modifiers disabled in the viewport, which the object keeps.
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
    """Position of an evaluated object, as the origin of positions."""
    return np.array(obj.evaluated_get(depsgraph).matrix_world.translation, np.float64)


def read_solids(
    objects: Iterable[bpy.types.Object],
    depsgraph: bpy.types.Depsgraph,
    origins: Iterable[FloatArray],
    selection: LayerSelection,
) -> list[Solid]:
    """Copies the meshes of objects, with modifiers, shape keys and instances.

    Args:
        objects: Objects, each once.
        depsgraph: The evaluated dependency graph.
        origins: Origin of the positions of each object.
        selection: Layers to read.

    Raises:
        ValueError: A coordinate is not finite; the message names the object.
    """
    objects = list(objects)
    readers = {
        obj: _Reader(Solid(obj.name), origin, selection)
        for obj, origin in zip(objects, origins, strict=True)
    }
    for obj, reader in readers.items():
        evaluated = obj.evaluated_get(depsgraph)
        solid = reader.solid
        solid.locked_groups.update(group.name for group in obj.vertex_groups if group.lock_weight)
        # Multires stores its details in the mesh, which is replaced.
        solid.kept_modifiers.update(
            modifier.name
            for modifier in obj.modifiers
            if not modifier.show_viewport and modifier.type != "MULTIRES"
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
            is_temporary = instance.instance_object.original == parent
            readers[parent].read(instance.object, matrix, is_temporary=is_temporary)
    return [reader.solid for reader in readers.values()]


def _is_seen_as_instances(obj: bpy.types.Object) -> bool:
    """Whether the dependency graph has all or a part of an object as instances.

    This includes the meshes of curves, texts and metaballs.
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
    """Reads the meshes of one solid; a mesh with many instances is read once."""

    def __init__(self, solid: Solid, origin: FloatArray, selection: LayerSelection) -> None:
        """Starts without parts."""
        self.solid = solid
        self._origin = origin
        self._selection = selection
        self._known: dict[int, _LocalMesh] = {}

    def read(
        self,
        shown: bpy.types.Object,
        matrix: FloatArray,
        *,
        is_own: bool = False,
        is_temporary: bool = False,
    ) -> None:
        """Adds an instance of the mesh of an evaluated object.

        Args:
            shown: The object.
            matrix: Its world matrix.
            is_own: Whether the mesh is the solid's own.
            is_temporary: Whether Blender created the object for a mesh without an object.
        """
        if len(shown.data.polygons) == 0:
            return
        key = shown.data.as_pointer()
        if key not in self._known:
            self._known[key] = self._copied(shown, shown.data, is_temporary=is_temporary)
        local = self._known[key]
        linear = matrix[:3, :3]
        positions = _transform(local.positions, linear, matrix[:3, 3] - self._origin)
        triangles = local.triangles
        layers = [layer.rotated(linear) for layer in local.layers]
        if np.linalg.det(linear) < 0:
            triangles = triangles[:, ::-1]
            layers = [layer.reversed() for layer in layers]
        # The object's own slots come first, and stay separate even if they have the same material.
        if is_own:
            indices = list(range(len(local.slots)))
        else:
            indices = [self._slot(key) for key in local.slots]
        slots = np.array(indices or [self._slot(None)], np.int32)
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
        self, shown: bpy.types.Object, mesh: bpy.types.Mesh, *, is_temporary: bool
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
        if is_temporary:
            slots = [MaterialKey.of(material) for material in mesh.materials]
        else:
            slots = [MaterialKey.of(slot.material) for slot in shown.material_slots]
        materials = attributes.face_materials(mesh, len(slots))
        if not (materials != materials[0]).any():
            materials = materials[:1]
        elif faces is not None:
            materials = materials[faces]
        layers = list(
            read_layers(shown, mesh, Triangles(triangles, corners, faces), self._selection)
        )
        marks = []
        if self._selection.attributes:
            marks = list(read_marks(mesh))
            self.solid.left_out |= unread(mesh)
        self._note_active(mesh)
        return _LocalMesh(positions, triangles, materials, slots, layers, marks, faces)

    def _check_finite(self, positions: NDArray[np.float32]) -> None:
        # A sum in double precision does not overflow, and needs no memory.
        if np.isfinite(positions.sum(dtype=np.float64)):
            return
        broken = np.flatnonzero(~np.isfinite(positions).all(axis=1))
        raise ValueError(
            f"object '{self.solid.name}': vertex {broken[0]} is at "
            f"{tuple(positions[broken[0]].tolist())}; coordinates must be finite"
        )

    def _note_active(self, mesh: bpy.types.Mesh) -> None:
        colors, maps = mesh.color_attributes, mesh.uv_layers
        active = {COLOR: colors.active_color_name or "", UV_MAP: maps.active.name if maps else ""}
        for kind, name in active.items():
            if name:
                self.solid.active.setdefault(kind, name)
        default = colors.render_color_index
        if 0 <= default < len(colors):
            self.solid.rendered.setdefault(COLOR, colors[default].name)
        rendered = next((layer.name for layer in maps if layer.active_render), "")
        if rendered:
            self.solid.rendered.setdefault(UV_MAP, rendered)


def _transform(positions: NDArray[np.float32], linear: FloatArray, offset: FloatArray) -> Positions:
    """Transforms points; the result is in double precision only if it is far from the origin."""
    if np.array_equal(linear, np.eye(3)) and not offset.any():
        return positions
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    placed: Positions = np.empty_like(positions)
    for start in range(0, len(positions), _ROWS):
        rows = positions[start : start + _ROWS].astype(np.float64) @ linear.T + offset
        placed[start : start + _ROWS] = rows
        low, high = np.minimum(low, rows.min(axis=0)), np.maximum(high, rows.max(axis=0))
    if np.abs([low, high]).max() <= _MAX_DISTANCE_FOR_SINGLE * (high - low).max():
        return placed
    return np.asarray(positions.astype(np.float64) @ linear.T + offset)
