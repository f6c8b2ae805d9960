"""Voxelizing and combining objects in three steps: read from Blender, compute, write to Blender.

The operators and the commands are two ways to call this.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial, reduce
from pathlib import Path

import bpy
import numpy as np
import prefilter
from mathutils import Matrix
from numpy.typing import NDArray

from .bridge import contours, files, solids, volumes
from .bridge.contours import Contour
from .jobs import Progress, go_on, share
from .solid_meshes import SolidMesh, join, solid_mesh
from .voxel_choices import BooleanSettings, VoxelizeSettings, VoxelSettings
from .voxel_grid import Box, Grid, check_dense_memory, check_memory, choose_grid
from .wording import counted, listed

_VOXELIZED, _CONTOURED = 0.5, 0.75
"""What the progress is once the tree is made, and once there is a surface."""


@dataclass
class Outcome:
    """What was made, and what the user should know about it.

    Attributes:
        summary: One line.
        objects: The names of the objects that show the results.
        warnings: What went less than well.
        notes: More that is good to know.
    """

    summary: str
    objects: list[str]
    warnings: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _Place:
    """Where the results of an object go: its name, and the way from its frame to its own space."""

    name: str
    origin: NDArray[np.float64]
    to_local: NDArray[np.float64]

    @classmethod
    def of(cls, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> "_Place":
        matrix = np.array(obj.evaluated_get(depsgraph).matrix_world, np.float64)
        linear = matrix[:3, :3]
        lengths = np.linalg.norm(linear, axis=0)
        # A matrix of tiny numbers is fine, one that is flat is not.
        if not np.all(lengths > 0.0) or abs(np.linalg.det(linear / lengths)) < 1e-6:
            raise ValueError(f"object '{obj.name}': its scale is 0 along an axis")
        return cls(obj.name, matrix[:3, 3].copy(), np.linalg.inv(linear))

    def localize(
        self, positions: NDArray[np.floating], triangles: NDArray[np.int32]
    ) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """Returns triangles in the object's space, right side out there too."""
        local = (positions.astype(np.float64) @ self.to_local.T).astype(np.float32)
        return local, triangles[:, ::-1] if np.linalg.det(self.to_local) < 0 else triangles


@dataclass(frozen=True)
class _Result:
    """A surface, or a staged file of a volume, and numbers about it."""

    place: _Place
    grid: Grid
    volume: float
    triangles: int
    contour: Contour | None = None
    staged: files.StagedFile | None = None


class Voxelization:
    """Objects voxelized one by one.

    `read` and `write` belong on the main thread; `compute` touches no Blender data and runs on any
    thread. Nothing is written before everything is computed.
    """

    def __init__(
        self,
        read: list[tuple[_Place, solids.Solid]],
        settings: VoxelizeSettings,
        targets: list[Path],
    ) -> None:
        """Keeps copies of what was read; use `Voxelization.read`."""
        self.warnings: list[str] = []
        self._notes: list[str] = []
        self._read = read
        self._settings = settings
        self._targets = targets
        self._results: list[_Result] = []

    @classmethod
    def read(
        cls,
        objects: Sequence[bpy.types.Object],
        settings: VoxelizeSettings,
        depsgraph: bpy.types.Depsgraph,
    ) -> "Voxelization":
        """Copies everything that the work needs out of Blender.

        Args:
            objects: What to voxelize, each by itself.
            settings: How.
            depsgraph: The evaluated dependency graph.

        Raises:
            ValueError: There is no object, or one is unfit.
            OSError: The file of a volume cannot be written.
        """
        if not objects:
            raise ValueError("no object is selected that has a surface")
        is_volume = settings.output == "volume"
        if is_volume and not volumes.is_available():
            raise OSError(volumes.NEEDED)
        if not is_volume:
            for obj in objects:
                contours.check_editable(obj)
        places = [_Place.of(obj, depsgraph) for obj in objects]
        found = solids.read_solids(objects, depsgraph, [place.origin for place in places])
        read = cls(list(zip(places, found, strict=True)), settings, [])
        read._leave_out_empty()
        if is_volume:
            read._targets = _volume_files([place.name for place, _ in read._read], settings)
        return read

    def compute(self, progress: Progress) -> None:
        """Voxelizes and contours.

        Raises:
            ValueError: An object encloses nothing, or its cells are too small.
            MemoryError: A result does not fit into memory.
            prefilter.Cancelled: `progress` has said so.
        """
        count = len(self._read)
        for i, (place, solid) in enumerate(self._read):
            part = share(progress, i / count, (i + 1) / count)
            with _naming(place.name):
                self._results.append(self._compute_one(i, place, solid, part))
        go_on(progress, 1.0)
        self._read.clear()

    def write(self) -> Outcome:
        """Puts the results into Blender.

        Raises:
            ValueError: An object is gone.
        """
        targets = [_still_there(result.place.name) for result in self._results]
        made = [
            self._show(obj, result).name for obj, result in zip(targets, self._results, strict=True)
        ]
        lines = [_told(result) for result in self._results]
        if len(lines) == 1:
            summary = f"Voxelized {lines[0]}"
        else:
            total = sum(result.triangles for result in self._results)
            summary = f"Voxelized {counted(lines, 'object')}: {total} triangles"
            self._notes = [*lines, *self._notes]
        return Outcome(summary, made, self.warnings, self._notes)

    def discard(self) -> None:
        """Removes what was staged."""
        for result in self._results:
            if result.staged is not None:
                result.staged.discard()

    def _leave_out_empty(self) -> None:
        empty = [place.name for place, solid in self._read if not solid.parts]
        self._read = [(place, solid) for place, solid in self._read if solid.parts]
        if not self._read:
            raise ValueError(
                f"object{'s' if len(empty) > 1 else ''} {listed(empty)}: found no faces"
            )
        if empty:
            self.warnings.append(f"left out, as they have no faces: {listed(empty)}")

    def _compute_one(
        self, index: int, place: _Place, solid: solids.Solid, progress: Progress
    ) -> _Result:
        mesh = solid_mesh(solid)
        _tell_defects(place.name, mesh, self.warnings, self._notes)
        grid = choose_grid(mesh.box, self._settings)
        check_memory(grid, mesh.area)
        if self._targets:
            check_dense_memory(grid)
        tree = _voxelized(mesh, grid, self._settings, share(progress, 0.0, _VOXELIZED))
        if self._targets:
            staged = files.stage_with(
                self._targets[index],
                lambda path: volumes.write_grid(
                    path, tree.dense(threads=self._settings.threads), grid.low, grid.spacing
                ),
            )
            return _Result(place, grid, tree.volume, 0, staged=staged)
        return _contoured(
            tree, grid, mesh, solid, place, self._settings, share(progress, _VOXELIZED, 1.0)
        )

    def _show(self, obj: bpy.types.Object, result: _Result) -> bpy.types.Object:
        if result.contour is not None:
            return contours.show_contour(obj, result.contour)
        result.staged.commit()
        volume = volumes.new_volume(obj.name, result.staged.target)
        made = contours.new_object_beside(obj, volume, ".volume")
        made.matrix_world = Matrix.Translation(result.place.origin)
        return made


class Boolean:
    """An object combined with others, in one grid of cells; in three steps as `Voxelization`."""

    def __init__(self, place: _Place, read: list[solids.Solid], settings: BooleanSettings) -> None:
        """Keeps copies of what was read; use `Boolean.read`."""
        self.warnings: list[str] = []
        self._notes: list[str] = []
        self._place = place
        self._read = read
        self._names = [solid.name for solid in read[1:]]
        self._settings = settings
        self._result: _Result | None = None

    @classmethod
    def read(
        cls,
        active: bpy.types.Object | None,
        others: Sequence[bpy.types.Object],
        settings: BooleanSettings,
        depsgraph: bpy.types.Depsgraph,
    ) -> "Boolean":
        """Copies everything that the work needs out of Blender.

        Args:
            active: The first operand, which gets the result.
            others: The other operands, at least one.
            settings: What to do.
            depsgraph: The evaluated dependency graph.

        Raises:
            ValueError: There are too few objects, or one is unfit.
        """
        if active is None or not others:
            raise ValueError("select two objects or more, one of them active")
        contours.check_editable(active)
        if settings.operands == "delete":
            for obj in others:
                contours.check_editable(obj)
        place = _Place.of(active, depsgraph)
        objects = [active, *others]
        read = solids.read_solids(objects, depsgraph, [place.origin] * len(objects))
        for solid in read:
            if not solid.parts:
                raise ValueError(f"object '{solid.name}': found no faces")
        return cls(place, read, settings)

    def compute(self, progress: Progress) -> None:
        """Voxelizes the operands, combines them and contours the result.

        Raises:
            ValueError: Nothing is left, or cells are too small.
            MemoryError: The result does not fit into memory.
            prefilter.Cancelled: `progress` has said so.
        """
        meshes = [solid_mesh(solid) for solid in self._read]
        for solid, mesh in zip(self._read, meshes, strict=True):
            _tell_defects(solid.name, mesh, self.warnings, self._notes)
        with _naming(self._place.name):
            grid = choose_grid(self._box([mesh.box for mesh in meshes]), self._settings)
            check_memory(grid, sum(mesh.area for mesh in meshes))
        trees = []
        for i, (solid, mesh) in enumerate(zip(self._read, meshes, strict=True)):
            start, end = (_VOXELIZED * k / len(meshes) for k in (i, i + 1))
            with _naming(solid.name):
                trees.append(_voxelized(mesh, grid, self._settings, share(progress, start, end)))
        combine = getattr(prefilter.Octree, self._settings.operation)
        tree = reduce(
            partial(
                combine, progress=lambda _: progress(_VOXELIZED), threads=self._settings.threads
            ),
            trees,
        )
        del trees
        with _naming(self._place.name):
            self._result = _contoured(
                tree,
                grid,
                join(_sharing_materials(self._read, meshes)),
                self._merged(),
                self._place,
                self._settings,
                share(progress, _VOXELIZED, 1.0),
            )
        go_on(progress, 1.0)
        self._read.clear()

    def write(self) -> Outcome:
        """Puts the result into the first operand, and does with the others as was chosen.

        Raises:
            ValueError: An object is gone.
        """
        result = self._result
        active = _still_there(result.place.name)
        others = [_still_there(name) for name in self._names]
        made = contours.show_contour(active, result.contour)
        for obj in others:
            if self._settings.operands == "hide":
                obj.hide_set(True)
                obj.hide_render = True
            elif self._settings.operands == "delete":
                bpy.data.objects.remove(obj)
        names = listed(self._names)
        what = {
            "difference": f"Difference with {names}",
            "union": f"Union with {names}",
            "intersection": f"Intersection with {names}",
        }[self._settings.operation]
        return Outcome(f"{what}: {_told(result)}", [made.name], self.warnings, self._notes)

    def discard(self) -> None:
        """Does nothing: nothing is staged."""

    def _box(self, boxes: list[Box]) -> Box:
        if self._settings.operation == "union":
            return (
                np.min([low for low, _ in boxes], axis=0),
                np.max([high for _, high in boxes], axis=0),
            )
        if self._settings.operation == "difference":
            return boxes[0]
        low = np.max([low for low, _ in boxes], axis=0)
        high = np.min([high for _, high in boxes], axis=0)
        if np.any(low >= high):
            raise ValueError("the objects have nothing in common")
        return low, high

    def _merged(self) -> solids.Solid:
        first = next((solid for solid in self._read if solid.active_color), self._read[0])
        return solids.Solid(
            self._place.name,
            [],
            self._read[0].materials,
            first.active_color,
            first.render_color,
        )


def _sharing_materials(read: list[solids.Solid], meshes: list[SolidMesh]) -> list[SolidMesh]:
    """Returns the operands with materials numbered as the first one's, which gets the others'."""
    shared = read[0].materials
    renumbered = []
    for solid, mesh in zip(read, meshes, strict=True):
        shared.extend(key for key in dict.fromkeys(solid.materials) if key not in shared)
        numbers = np.array([shared.index(key) for key in solid.materials], np.int32)
        renumbered.append(replace(mesh, materials=numbers[mesh.materials]))
    return renumbered


def _voxelized(
    mesh: SolidMesh, grid: Grid, settings: VoxelSettings, progress: Progress
) -> "prefilter.Octree":
    positions, triangles = mesh.positions, mesh.triangles
    if settings.use_close_holes and mesh.open_edges:
        closed = prefilter.close_holes(positions, triangles, progress=share(progress, 0.0, 0.3))
        positions, triangles = closed.positions, closed.triangles
    return prefilter.voxelize(
        positions,
        triangles,
        depth=grid.depth,
        bounds=grid.bounds,
        progress=share(progress, 0.3, 1.0),
        threads=settings.threads,
    )


def _contoured(
    tree: "prefilter.Octree",
    grid: Grid,
    mesh: SolidMesh,
    solid: solids.Solid,
    place: _Place,
    settings: VoxelSettings,
    progress: Progress,
) -> _Result:
    middle = (_CONTOURED - _VOXELIZED) / (1.0 - _VOXELIZED)
    positions, triangles = tree.contour(
        interpolant=settings.interpolant,
        cleanup=settings.use_cleanup,
        progress=share(progress, 0.0, middle),
        threads=settings.threads,
    )
    if len(triangles) == 0:
        raise ValueError(
            "nothing is left: no cell is half full. What is thinner than a cell, or encloses "
            "nothing, has no voxels"
        )
    face_materials, colors = _transferred(
        mesh, positions, triangles, settings, share(progress, middle, 1.0)
    )
    local, turned = place.localize(positions, triangles)
    contour = Contour(
        local,
        turned,
        solid.materials if settings.use_materials else (),
        face_materials,
        colors,
        solid.active_color,
        solid.render_color,
        settings.smooth_angle if settings.use_smooth else None,
    )
    return _Result(place, grid, tree.volume, len(triangles), contour)


def _transferred(
    mesh: SolidMesh,
    positions: NDArray[np.float32],
    triangles: NDArray[np.int32],
    settings: VoxelSettings,
    progress: Progress,
) -> tuple[NDArray[np.int32] | None, dict[str, tuple[str, NDArray[np.float32]]]]:
    """Returns the materials of triangles and the colours of vertices, from the nearest surface."""
    with_materials = settings.use_materials and mesh.has_several_materials()
    with_colors = settings.use_colors and bool(mesh.colors)
    face_materials = None
    if settings.use_materials and len(mesh.materials):
        face_materials = np.full(len(triangles), mesh.materials[0], np.int32)
    colors: dict[str, tuple[str, NDArray[np.float32]]] = {}
    if not with_materials and not with_colors:
        return face_materials, colors
    # One call for both, as each prepares the mesh anew.
    points = [
        *([positions[triangles].mean(axis=1)] if with_materials else []),
        *([positions] if with_colors else []),
    ]
    nearest, weights, _ = prefilter.nearest_points(
        np.concatenate(points),
        mesh.positions,
        mesh.triangles,
        progress=progress,
        threads=settings.threads,
    )
    if with_materials:
        face_materials = mesh.materials[nearest[: len(triangles)]]
    if with_colors:
        nearest, weights = nearest[-len(positions) :], weights[-len(positions) :]
        for name, color in mesh.colors.items():
            corners = color.values[color.corners[nearest]]
            blended = np.einsum("ij,ijk->ik", weights, corners).astype(np.float32)
            colors[name] = (color.data_type, blended)
    return face_materials, colors


def _tell_defects(name: str, mesh: SolidMesh, warnings: list[str], notes: list[str]) -> None:
    if mesh.flipped:
        warnings.append(f"object '{name}' was inside out; its faces count as turned")
    if mesh.open_edges:
        edges = "1 open edge" if mesh.open_edges == 1 else f"{mesh.open_edges} open edges"
        notes.append(f"object '{name}' has {edges}; the result is closed")


def _told(result: _Result) -> str:
    cells = f"'{result.place.name}' in {result.grid.cells}³ cells of {_length(result.grid.spacing)}"
    triangles = f"{result.triangles} triangles, " if result.contour is not None else ""
    return f"{cells}: {triangles}volume {_in_units(result.volume, 'VOLUME')}"


def _length(value: float) -> str:
    return _in_units(value, "LENGTH")


def _in_units(value: float, category: str) -> str:
    units = bpy.context.scene.unit_settings
    if units.system == "NONE":
        return f"{value:.4g}"
    scaled = value * units.scale_length ** (3 if category == "VOLUME" else 1)
    return bpy.utils.units.to_string(units.system, category, scaled, precision=4)


def _volume_files(names: list[str], settings: VoxelizeSettings) -> list[Path]:
    """Returns the file of each volume; of several, each is named after its object too."""
    if settings.filepath:
        path = Path(bpy.path.abspath(settings.filepath))
        paths = [path]
        if len(names) > 1:
            paths = [path.with_stem(f"{path.stem}.{bpy.path.clean_name(name)}") for name in names]
    elif bpy.data.is_saved:
        folder = Path(bpy.data.filepath).parent
        paths = [folder / f"{bpy.path.clean_name(name)}.vdb" for name in names]
    else:
        raise ValueError("filepath: a volume needs a file: name one, or save the .blend file first")
    return [files.check_plain_target(str(path), ".vdb") for path in paths]


def _still_there(name: str) -> bpy.types.Object:
    obj = bpy.data.objects.get(name)
    if obj is None:
        raise ValueError(f"object '{name}' is gone")
    if obj.mode != "OBJECT":
        raise ValueError(f"object '{name}' is not in Object Mode any more")
    return obj


@contextmanager
def _naming(name: str) -> Iterator[None]:
    """Puts the name of an object before messages."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"object '{name}': {error}") from error
    except MemoryError as error:
        raise MemoryError(f"object '{name}': {error}") from error
