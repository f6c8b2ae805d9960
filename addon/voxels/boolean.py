# SPDX-License-Identifier: GPL-3.0-or-later

"""Set operations on objects, in the same three steps as voxelizing: read, compute, write."""

from collections.abc import Generator, Sequence
from dataclasses import replace

import bpy
import numpy as np
from prefilter.workflows.voxels import booleans

from ..bridge import new_meshes, solids
from ..bridge.kept_sources import keep_more
from ..bridge.target_frame import TargetFrame, find_object, prefix_errors
from ..bridge.units import length
from ..core.jobs import Progress, go_on, parts, share
from ..core.options import check
from ..core.outcome import Outcome
from ..core.translations import marked
from ..core.wording import Sentence, listed
from .choices import BooleanSettings
from .grid import Box, Grid, check_memory, choose_grid
from .placement import Placement, show
from .steps import (
    VOXELIZED,
    Load,
    Messages,
    Operand,
    Result,
    contour_tree,
    layers_to_read,
    summarize,
    voxelize,
)
from .transfer import renumber_materials

_DONE = {
    "difference": marked("Difference with {}: {}"),
    "union": marked("Union with {}: {}"),
    "intersection": marked("Intersection with {}: {}"),
}


class Boolean:
    """Combines an object with others in one grid of cells; see `Voxelization`."""

    def __init__(
        self, frame: TargetFrame, read: list[solids.Solid], settings: BooleanSettings
    ) -> None:
        """Keeps copied solids; use `Boolean.read`."""
        self._messages = Messages()
        self.loads: list[Load] = []
        self.placement = Placement.ALONE
        self._frame = frame
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
        """Copies the operands out of Blender.

        Args:
            active: The first operand, which gets the result.
            others: The other operands, at least one.
            settings: The settings.
            depsgraph: The evaluated dependency graph.
            into: Name of the object that gets the result; empty for the first operand.

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
        frame = TargetFrame.of(active, depsgraph, into)
        objects = [active, *others]
        read = solids.read_solids(
            objects, depsgraph, [frame.origin] * len(objects), layers_to_read(settings)
        )
        for solid in read:
            if not solid.parts:
                raise ValueError(Sentence("object {}: found no faces", listed([solid.name])))
        return cls(frame, read, settings)

    @property
    def result(self) -> Result:
        """The computed result."""
        assert self._result is not None
        return self._result

    def compute(self, progress: Progress) -> None:
        """Voxelizes the operands, combines them and contours the result.

        Raises:
            ValueError: Nothing is left, or cells are too small.
            MemoryError: The result does not fit into memory.
            prefilter.Cancelled: `progress` returned False.
        """
        operands = []
        for solid in self._read:
            with prefix_errors(solid.name):
                operands.append(Operand.of(solid, self._settings))
        operands = _sharing_materials(self._read, operands)
        with prefix_errors(self._frame.name):
            boxes = [operand.measures.box for operand in operands]
            box = booleans.box(boxes, self._settings.operation)
            self.loads = [Load.of(box, operands)]
            grid = self._grid(box)
            check_memory(grid, sum(operand.measures.area for operand in operands))
        trees, sources = [], []
        steps = parts(share(progress, 0.0, VOXELIZED), len(operands))
        for operand, part in zip(operands, steps, strict=True):
            with prefix_errors(operand.name):
                tree, source = voxelize(operand, grid, self._settings, self._messages, part)
            trees.append(tree)
            sources.append(source)
        tree = booleans.combined(
            trees,
            self._settings.operation,
            share(progress, VOXELIZED, 1.0),
            self._settings.threads,
        )
        del trees
        with prefix_errors(self._frame.name):
            self._result = contour_tree(
                tree,
                grid,
                sources,
                self._merged(),
                self._frame,
                self._settings,
                share(progress, VOXELIZED, 1.0),
            )
        go_on(progress, 1.0)
        self._read.clear()

    def build_steps(self) -> Generator[None, None, None]:
        """Makes the result's mesh in steps, before `write` shows it."""
        assert self._result is not None
        assert self._result.contour is not None
        yield from new_meshes.making_mesh(self._result.contour)

    def write(self) -> Outcome:
        """Puts the result into the first operand; hides or deletes the others if so chosen.

        Raises:
            ValueError: An object is gone.
        """
        result = self._result
        assert result is not None
        assert result.contour is not None
        active = find_object(result.frame.name)
        others = [find_object(name) for name in self._names]
        report = self._messages.add_summary(result, self._messages.findings, self._settings)
        made = show(active, result, self._settings, others, report, self.placement)
        for obj in others if self.placement != Placement.AGAIN else ():
            if self._settings.operands == "hide":
                obj.hide_set(True)
                obj.hide_render = True
                keep_more(made, [obj])
            elif self._settings.operands == "delete":
                bpy.data.objects.remove(obj)
        names = listed(self._names)
        return Outcome(
            Sentence(_DONE[self._settings.operation], names, summarize(result, self._settings)),
            objects=[made.name],
            warnings=self._messages.warnings,
            notes=self._messages.notes,
        )

    def discard(self) -> None:
        """Removes a mesh that was made and is not shown."""
        if self._result is not None and self._result.contour is not None:
            new_meshes.forget_mesh(self._result.contour)

    def _grid(self, box: Box) -> Grid:
        """Chooses the cells; falls back to the depth if kept cells would be too many."""
        settings = self._settings
        try:
            return choose_grid(box, settings)
        except ValueError:
            if not (settings.use_keep_resolution and settings.resolution == "size"):
                raise
        cells = length(settings.voxel_size)
        self._messages.notes.append(Sentence("too many cells of {}: the depth counts", cells))
        return choose_grid(box, replace(settings, resolution="depth"))

    def _merged(self) -> solids.Solid:
        merged = solids.Solid(self._frame.name, [], self._read[0].materials)
        merged.kept_modifiers |= self._read[0].kept_modifiers
        for solid in reversed(self._read):
            merged.marks += solid.marks
            merged.locked_groups |= solid.locked_groups
            merged.active |= solid.active
            merged.rendered |= solid.rendered
        return merged


def _sharing_materials(read: list[solids.Solid], operands: list[Operand]) -> list[Operand]:
    """Renumbers the operands' materials to slots of the first one, which gets missing ones.

    Several slots with the same material remain as many as in the operand that has the most.
    """
    shared = read[0].materials
    numbers = []
    for solid in read:
        slots: list[int] = []
        for key in solid.materials:
            free = [i for i, other in enumerate(shared) if other == key and i not in slots]
            if not free:
                free = [len(shared)]
                shared.append(key)
            slots.append(free[0])
        numbers.append(np.array(slots, np.int32))
    meshes = renumber_materials([operand.mesh for operand in operands], numbers)
    return [replace(operand, mesh=mesh) for operand, mesh in zip(operands, meshes, strict=True)]
