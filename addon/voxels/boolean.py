# SPDX-License-Identifier: GPL-3.0-or-later

"""Set operations on objects, in the same three steps as voxelizing them."""

from collections.abc import Generator, Sequence
from dataclasses import replace

import bpy
import numpy as np
from prefilter.workflows.voxels import booleans

from ..bridge import new_meshes, solids
from ..bridge.kept_sources import keep_more
from ..bridge.place import Place, naming, still_there
from ..bridge.units import length
from ..core.jobs import Progress, go_on, parts, share
from ..core.options import check
from ..core.outcome import Outcome
from ..core.translations import marked
from ..core.wording import Sentence, listed
from .choices import BooleanSettings
from .grid import Box, Grid, check_memory, choose_grid
from .showing import Way, show
from .steps import VOXELIZED, Load, Operand, Result, Told, contoured, told, voxelized, wanted
from .transfer import renumbered

_DONE = {
    "difference": marked("Difference with {}: {}"),
    "union": marked("Union with {}: {}"),
    "intersection": marked("Intersection with {}: {}"),
}


class Boolean:
    """An object combined with others, in one grid of cells; in three steps as `Voxelization`."""

    def __init__(self, place: Place, read: list[solids.Solid], settings: BooleanSettings) -> None:
        """Keeps copies of what was read; use `Boolean.read`."""
        self._told = Told()
        self.loads: list[Load] = []
        self.way = Way.ALONE
        self._place = place
        self._read = read
        self._names = [solid.name for solid in read[1:]]
        self._settings = settings
        self._result: Result | None = None

    @classmethod
    def read(
        cls,
        active: bpy.types.Object | None,
        others: Sequence[bpy.types.Object],
        settings: BooleanSettings,
        depsgraph: bpy.types.Depsgraph,
        into: str = "",
    ) -> "Boolean":
        """Copies everything that the work needs out of Blender.

        Args:
            active: The first operand, which gets the result.
            others: The other operands, at least one.
            settings: What to do.
            depsgraph: The evaluated dependency graph.
            into: The name of the object that gets the result; empty for the first operand.

        Raises:
            ValueError: There are too few objects, or one is unfit.
        """
        check(settings)
        if active is None or not others:
            raise ValueError(Sentence("select two objects or more, one of them active"))
        new_meshes.check_editable(active)
        if settings.operands == "delete":
            for obj in others:
                new_meshes.check_editable(obj)
        place = Place.of(active, depsgraph, into)
        objects = [active, *others]
        read = solids.read_solids(
            objects, depsgraph, [place.origin] * len(objects), wanted(settings)
        )
        for solid in read:
            if not solid.parts:
                raise ValueError(Sentence("object {}: found no faces", listed([solid.name])))
        return cls(place, read, settings)

    @property
    def result(self) -> Result:
        """What was computed."""
        assert self._result is not None
        return self._result

    def compute(self, progress: Progress) -> None:
        """Voxelizes the operands, combines them and contours the result.

        Raises:
            ValueError: Nothing is left, or cells are too small.
            MemoryError: The result does not fit into memory.
            prefilter.Cancelled: `progress` has said so.
        """
        operands = []
        for solid in self._read:
            with naming(solid.name):
                operands.append(Operand.of(solid, self._settings))
        operands = _sharing_materials(self._read, operands)
        with naming(self._place.name):
            boxes = [one.measures.box for one in operands]
            box = booleans.box(boxes, self._settings.operation)
            self.loads = [Load.of(box, operands)]
            grid = self._grid(box)
            check_memory(grid, sum(one.measures.area for one in operands))
        trees, sources = [], []
        steps = parts(share(progress, 0.0, VOXELIZED), len(operands))
        for operand, part in zip(operands, steps, strict=True):
            with naming(operand.name):
                tree, source = voxelized(operand, grid, self._settings, self._told, part)
            trees.append(tree)
            sources.append(source)
        tree = booleans.combined(
            trees,
            self._settings.operation,
            share(progress, VOXELIZED, 1.0),
            self._settings.threads,
        )
        del trees
        with naming(self._place.name):
            self._result = contoured(
                tree,
                grid,
                sources,
                self._merged(),
                self._place,
                self._settings,
                share(progress, VOXELIZED, 1.0),
            )
        go_on(progress, 1.0)
        self._read.clear()

    def build_steps(self) -> Generator[None, None, None]:
        """Makes the mesh that `write` shows, in steps."""
        assert self._result is not None
        assert self._result.contour is not None
        yield from new_meshes.making_mesh(self._result.contour)

    def write(self) -> Outcome:
        """Puts the result into the first operand, and does with the others as was chosen.

        Raises:
            ValueError: An object is gone.
        """
        result = self._result
        assert result is not None
        assert result.contour is not None
        active = still_there(result.place.name)
        others = [still_there(name) for name in self._names]
        report = self._told.sum_up(result, self._told.findings, self._settings)
        made = show(active, result, self._settings, others, report, self.way)
        for obj in others if self.way != Way.AGAIN else ():
            if self._settings.operands == "hide":
                obj.hide_set(True)
                obj.hide_render = True
                keep_more(made, [obj])
            elif self._settings.operands == "delete":
                bpy.data.objects.remove(obj)
        names = listed(self._names)
        return Outcome(
            Sentence(_DONE[self._settings.operation], names, told(result, self._settings)),
            objects=[made.name],
            warnings=self._told.warnings,
            notes=self._told.notes,
        )

    def discard(self) -> None:
        """Removes a mesh that nothing shows."""
        if self._result is not None and self._result.contour is not None:
            new_meshes.forget_mesh(self._result.contour)

    def _grid(self, box: Box) -> Grid:
        """Returns the cells: of a depth where those that were to be kept are too many."""
        settings = self._settings
        try:
            return choose_grid(box, settings)
        except ValueError:
            if not (settings.use_keep_resolution and settings.resolution == "size"):
                raise
        cells = length(settings.voxel_size)
        self._told.notes.append(Sentence("too many cells of {}: the depth counts", cells))
        return choose_grid(box, replace(settings, resolution="depth"))

    def _merged(self) -> solids.Solid:
        merged = solids.Solid(self._place.name, [], self._read[0].materials)
        merged.kept_modifiers |= self._read[0].kept_modifiers
        for solid in reversed(self._read):
            merged.marks += solid.marks
            merged.locked_groups |= solid.locked_groups
            merged.active |= solid.active
            merged.rendered |= solid.rendered
        return merged


def _sharing_materials(read: list[solids.Solid], operands: list[Operand]) -> list[Operand]:
    """Returns the operands with materials numbered as the first one's, which gets the others'.

    Slots with one material stay as many as they are in the operand that has the most.
    """
    shared = read[0].materials
    numbers = []
    for solid in read:
        found: list[int] = []
        for key in solid.materials:
            free = [i for i, other in enumerate(shared) if other == key and i not in found]
            if not free:
                free = [len(shared)]
                shared.append(key)
            found.append(free[0])
        numbers.append(np.array(found, np.int32))
    meshes = renumbered([one.mesh for one in operands], numbers)
    return [replace(one, mesh=mesh) for one, mesh in zip(operands, meshes, strict=True)]
