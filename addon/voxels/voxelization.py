# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxelizing objects in three steps: read from Blender, compute, write to Blender.

The operator and the command are two ways to call this.
"""

from collections.abc import Generator, Sequence
from dataclasses import asdict
from pathlib import Path

import bpy
from mathutils import Matrix
from prefilter.workflows.up_to_date import arrays_of, fingerprint, fingerprint_of
from prefilter.workflows.voxels.empty_results import EmptyResults, NothingLeftError, check_area

from ..bridge import new_meshes, solids
from ..bridge.armatures import at_rest
from ..bridge.files import staging, volumes
from ..bridge.target_frame import TargetFrame, find_object, prefix_errors
from ..core.file_names import clean_names
from ..core.jobs import Progress, go_on, parts, share
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, counted, listed
from .choices import VoxelizeSettings
from .findings import Report
from .grid import check_dense_memory, check_memory, choose_grid
from .placement import Placement, show
from .steps import (
    VOXELIZED,
    Load,
    Messages,
    Operand,
    Result,
    contour_tree,
    faces_of,
    layers_to_read,
    summarize,
    voxelize,
)


class Voxelization:
    """Voxelizes objects one by one.

    `read` and `write` run on the main thread; `compute` uses no Blender data and runs on any
    thread. Nothing is written before everything is computed.
    """

    def __init__(
        self,
        read: list[tuple[TargetFrame, solids.Solid]],
        settings: VoxelizeSettings,
        targets: list[Path],
    ) -> None:
        """Keeps copied solids; use `Voxelization.read`."""
        self._messages = Messages()
        self.loads: list[Load] = []
        self.placement = Placement.ALONE
        self._read = read
        self._settings = settings
        self._targets = targets
        self._results: list[Result] = []

    @classmethod
    def read(
        cls,
        objects: Sequence[bpy.types.Object],
        settings: VoxelizeSettings,
        depsgraph: bpy.types.Depsgraph,
        into: str = "",
    ) -> "Voxelization":
        """Copies the objects' solids out of Blender.

        Args:
            objects: Objects to voxelize, each by itself.
            settings: The settings.
            depsgraph: The evaluated dependency graph.
            into: Name of the object that gets the result; empty: each object gets its own.

        Raises:
            ValueError: There is no object, or one cannot be voxelized.
            OSError: The file of a volume cannot be written.
        """
        check(settings)
        if not objects:
            raise ValueError(Sentence("no object is selected that has a surface"))
        is_volume = settings.output == "volume"
        if is_volume and not volumes.is_available():
            raise OSError(volumes.NEEDED)
        if not is_volume:
            for obj in objects:
                new_meshes.check_editable(obj)
        # Armatures keep deforming the result, if it has weights.
        rigged = objects if settings.use_attributes and not is_volume else []
        with at_rest(rigged, depsgraph):
            frames = [TargetFrame.of(obj, depsgraph, into) for obj in objects]
            read = solids.read_solids(
                objects, depsgraph, [frame.origin for frame in frames], layers_to_read(settings)
            )
        work = cls(list(zip(frames, read, strict=True)), settings, [])
        work._leave_out_empty()
        if is_volume:
            work._targets = _volume_files([frame.name for frame, _ in work._read], settings)
        return work

    @property
    def result(self) -> Result:
        """The result of the only object."""
        return self._results[0]

    def inputs(self, files: Sequence[str]) -> str:
        """Fingerprint of the copied solids, the settings and some files.

        Args:
            files: Files that are not read here but affect the output, such as materials.

        Raises:
            OSError: A file cannot be read.
        """
        settings = asdict(self._settings)
        for name in ("threads", "filepath"):
            del settings[name]
        read = fingerprint_of(arrays_of(self._read), settings)
        return fingerprint(files, {"read": read, "blender": bpy.app.version_string})

    def compute(self, progress: Progress) -> None:
        """Computes the results.

        Raises:
            ValueError: The cells of an object are too small, or nothing is left of any.
            MemoryError: A result does not fit into memory.
            prefilter.Cancelled: `progress` returned False.
        """
        steps, left_out = parts(progress, len(self._read)), EmptyResults()
        for i, ((frame, solid), part) in enumerate(zip(self._read, steps, strict=True)):
            messages = Messages()
            with prefix_errors(frame.name):
                try:
                    result = self._compute_one(i, frame, solid, messages, part)
                except NothingLeftError as error:
                    left_out.add(frame.name, error)
                    continue
            self._results.append(result)
            self._messages.extend(messages)
        self._messages.warnings += left_out.warnings_for(self._results)
        go_on(progress, 1.0)
        self._read.clear()

    def build_steps(self) -> Generator[None, None, None]:
        """Makes the results' meshes in steps, before `write` shows them."""
        for result in self._results:
            if result.contour is not None:
                yield from new_meshes.making_mesh(result.contour)

    def write(self) -> Outcome:
        """Puts the results into Blender.

        Raises:
            ValueError: An object is gone.
            OSError: A file cannot be written; then no file is.
        """
        targets = [find_object(result.frame.name) for result in self._results]
        staging.commit_all([result.staged for result in self._results if result.staged is not None])
        made = []
        findings = self._messages.findings
        for obj, result, each in zip(targets, self._results, findings, strict=True):
            report = self._messages.add_summary(result, [each], self._settings)
            made.append(self._show(obj, result, report).name)
        lines = [summarize(result, self._settings) for result in self._results]
        notes = self._messages.notes
        if len(lines) == 1:
            summary = Sentence("Voxelized {}", lines[0])
        else:
            faces = faces_of(self._settings, sum(result.faces for result in self._results))
            summary = Sentence("Voxelized {}: {}", counted(lines, "object"), faces)
            notes = [*lines, *notes]
        return Outcome(summary, objects=made, warnings=self._messages.warnings, notes=notes)

    def discard(self) -> None:
        """Removes staged files and unused meshes."""
        for result in self._results:
            if result.staged is not None:
                result.staged.discard()
            if result.contour is not None:
                new_meshes.forget_mesh(result.contour)

    def _leave_out_empty(self) -> None:
        empty = [frame.name for frame, solid in self._read if not solid.parts]
        self._read = [(frame, solid) for frame, solid in self._read if solid.parts]
        if not self._read:
            raise ValueError(_no_faces(empty))
        if empty:
            text = "left out, as they have no faces: {}"
            self._messages.warnings.append(Sentence(text, listed(empty)))

    def _compute_one(
        self,
        index: int,
        frame: TargetFrame,
        solid: solids.Solid,
        messages: Messages,
        progress: Progress,
    ) -> Result:
        operand = Operand.of(solid, self._settings)
        check_area(operand.measures.area)
        # Saves memory: only the operand refers to the arrays now.
        solid.parts.clear()
        box, area = operand.measures.box, operand.measures.area
        self.loads.append(Load.of(box, [operand]))
        grid = choose_grid(box, self._settings)
        check_memory(grid, area)
        if self._targets:
            check_dense_memory(grid)
        steps = share(progress, 0.0, VOXELIZED)
        tree, source = voxelize(operand, grid, self._settings, messages, steps)
        del operand
        if self._targets:
            staged = staging.stage_with(
                self._targets[index],
                lambda path: volumes.write_grid(
                    path, tree.dense(threads=self._settings.threads), grid.low, grid.spacing
                ),
            )
            return Result(frame, grid, tree.volume, 0, staged=staged)
        return contour_tree(
            tree, grid, [source], solid, frame, self._settings, share(progress, VOXELIZED, 1.0)
        )

    def _show(self, obj: bpy.types.Object, result: Result, report: Report) -> bpy.types.Object:
        if result.contour is not None:
            return show(obj, result, self._settings, (), report, self.placement)
        assert result.staged is not None
        volume = volumes.new_volume(obj.name, result.staged.target)
        made = new_meshes.new_object_beside(obj, volume, ".volume")
        made.matrix_world = Matrix.Translation(result.frame.origin)
        return made


def _volume_files(names: list[str], settings: VoxelizeSettings) -> list[Path]:
    """Files of the volumes; several are named after their objects, too."""
    if settings.filepath:
        path = Path(bpy.path.abspath(settings.filepath))
        paths = [path]
        if len(names) > 1:
            paths = [path.with_stem(f"{path.stem}.{name}") for name in clean_names(names)]
    elif bpy.data.is_saved:
        folder = Path(bpy.data.filepath).parent
        paths = [folder / f"{name}.vdb" for name in clean_names(names)]
    else:
        raise ValueError(
            Sentence("File: choose a file for the volume, or save the .blend file first")
        )
    return [staging.check_plain_target(str(path), ".vdb") for path in paths]


def _no_faces(names: list[str]) -> Sentence:
    if len(names) == 1:
        return Sentence("object {}: found no faces", listed(names))
    return Sentence("objects {}: found no faces", listed(names))
