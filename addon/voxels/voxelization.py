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
from ..bridge.place import Place, naming, still_there
from ..core.file_names import clean_names
from ..core.jobs import Progress, go_on, parts, share
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, counted, listed
from .choices import VoxelizeSettings
from .findings import Report
from .grid import check_dense_memory, check_memory, choose_grid
from .showing import Way, show
from .steps import (
    VOXELIZED,
    Load,
    Operand,
    Result,
    Told,
    contoured,
    faces_of,
    told,
    voxelized,
    wanted,
)


class Voxelization:
    """Objects voxelized one by one.

    `read` and `write` belong on the main thread; `compute` touches no Blender data and runs on any
    thread. Nothing is written before everything is computed.
    """

    def __init__(
        self,
        read: list[tuple[Place, solids.Solid]],
        settings: VoxelizeSettings,
        targets: list[Path],
    ) -> None:
        """Keeps copies of what was read; use `Voxelization.read`."""
        self._told = Told()
        self.loads: list[Load] = []
        self.way = Way.ALONE
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
        """Copies everything that the work needs out of Blender.

        Args:
            objects: What to voxelize, each by itself.
            settings: How.
            depsgraph: The evaluated dependency graph.
            into: The name of the object that gets the result of one; each gets its own if empty.

        Raises:
            ValueError: There is no object, or one is unfit.
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
        # They deform the result as long as that has weights.
        rigged = objects if settings.use_attributes and not is_volume else []
        with at_rest(rigged, depsgraph):
            places = [Place.of(obj, depsgraph, into) for obj in objects]
            found = solids.read_solids(
                objects, depsgraph, [place.origin for place in places], wanted(settings)
            )
        read = cls(list(zip(places, found, strict=True)), settings, [])
        read._leave_out_empty()
        if is_volume:
            read._targets = _volume_files([place.name for place, _ in read._read], settings)
        return read

    @property
    def result(self) -> Result:
        """What was computed of the only object."""
        return self._results[0]

    def inputs(self, files: Sequence[str]) -> str:
        """Returns a number of what was read, of how it is used, and of some files.

        Args:
            files: What is not read here, but decides what is written, such as materials.

        Raises:
            OSError: A file cannot be read.
        """
        settings = asdict(self._settings)
        for name in ("threads", "filepath"):
            del settings[name]
        read = fingerprint_of(arrays_of(self._read), settings)
        return fingerprint(files, {"read": read, "blender": bpy.app.version_string})

    def compute(self, progress: Progress) -> None:
        """Voxelizes and contours.

        Raises:
            ValueError: The cells of an object are too small, or nothing is left of any.
            MemoryError: A result does not fit into memory.
            prefilter.Cancelled: `progress` has said so.
        """
        steps, left_out = parts(progress, len(self._read)), EmptyResults()
        for i, ((place, solid), part) in enumerate(zip(self._read, steps, strict=True)):
            found = Told()
            with naming(place.name):
                try:
                    result = self._compute_one(i, place, solid, found, part)
                except NothingLeftError as error:
                    left_out.add(place.name, error)
                    continue
            self._results.append(result)
            self._told.add(found)
        self._told.warnings += left_out.warnings_for(self._results)
        go_on(progress, 1.0)
        self._read.clear()

    def build_steps(self) -> Generator[None, None, None]:
        """Makes the meshes that `write` shows, in steps."""
        for result in self._results:
            if result.contour is not None:
                yield from new_meshes.making_mesh(result.contour)

    def write(self) -> Outcome:
        """Puts the results into Blender.

        Raises:
            ValueError: An object is gone.
            OSError: A file cannot be put into place; then none is.
        """
        targets = [still_there(result.place.name) for result in self._results]
        staging.commit_all([result.staged for result in self._results if result.staged is not None])
        made = []
        for obj, result, found in zip(targets, self._results, self._told.findings, strict=True):
            report = self._told.sum_up(result, [found], self._settings)
            made.append(self._show(obj, result, report).name)
        lines = [told(result, self._settings) for result in self._results]
        notes = self._told.notes
        if len(lines) == 1:
            summary = Sentence("Voxelized {}", lines[0])
        else:
            faces = faces_of(self._settings, sum(result.faces for result in self._results))
            summary = Sentence("Voxelized {}: {}", counted(lines, "object"), faces)
            notes = [*lines, *notes]
        return Outcome(summary, objects=made, warnings=self._told.warnings, notes=notes)

    def discard(self) -> None:
        """Removes what was staged."""
        for result in self._results:
            if result.staged is not None:
                result.staged.discard()
            if result.contour is not None:
                new_meshes.forget_mesh(result.contour)

    def _leave_out_empty(self) -> None:
        empty = [place.name for place, solid in self._read if not solid.parts]
        self._read = [(place, solid) for place, solid in self._read if solid.parts]
        if not self._read:
            raise ValueError(_no_faces(empty))
        if empty:
            text = "left out, as they have no faces: {}"
            self._told.warnings.append(Sentence(text, listed(empty)))

    def _compute_one(
        self, index: int, place: Place, solid: solids.Solid, found: Told, progress: Progress
    ) -> Result:
        operand = Operand.of(solid, self._settings)
        check_area(operand.measures.area)
        # Memory counts: what was read is the operand's, and goes with it.
        solid.parts.clear()
        box, area = operand.measures.box, operand.measures.area
        self.loads.append(Load.of(box, [operand]))
        grid = choose_grid(box, self._settings)
        check_memory(grid, area)
        if self._targets:
            check_dense_memory(grid)
        steps = share(progress, 0.0, VOXELIZED)
        tree, source = voxelized(operand, grid, self._settings, found, steps)
        del operand
        if self._targets:
            staged = staging.stage_with(
                self._targets[index],
                lambda path: volumes.write_grid(
                    path, tree.dense(threads=self._settings.threads), grid.low, grid.spacing
                ),
            )
            return Result(place, grid, tree.volume, 0, staged=staged)
        return contoured(
            tree, grid, [source], solid, place, self._settings, share(progress, VOXELIZED, 1.0)
        )

    def _show(self, obj: bpy.types.Object, result: Result, report: Report) -> bpy.types.Object:
        if result.contour is not None:
            return show(obj, result, self._settings, (), report, self.way)
        assert result.staged is not None
        volume = volumes.new_volume(obj.name, result.staged.target)
        made = new_meshes.new_object_beside(obj, volume, ".volume")
        made.matrix_world = Matrix.Translation(result.place.origin)
        return made


def _volume_files(names: list[str], settings: VoxelizeSettings) -> list[Path]:
    """Returns the file of each volume; of several, each is named after its object too."""
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
