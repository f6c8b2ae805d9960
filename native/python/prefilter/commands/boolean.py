# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `boolean`."""

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import prefilter

from ..files import staging
from ..meshes.measures import MeshMeasures, measure_mesh
from ..options.flags import add_flags, tables
from ..options.voxels import BooleanSettings
from ..workflows import mesh_extensions, mesh_files
from ..workflows.mesh_files import NamedMesh
from ..workflows.outcome import Outcome
from ..workflows.progress import Progress, go_on, parts, share
from ..workflows.voxels import booleans, surfaces
from ..workflows.voxels.empty_results import NO_FILLED_CELL, NothingLeftError
from ..workflows.voxels.grid import check_memory, choose_grid
from ..workflows.wording import amount, either, listed
from . import cli_common, outputs, voxelize
from .host import PLAIN

FLAGS = (*voxelize.FLAGS, "operation")
"""The options that work without Blender."""
_VOXELIZED, _COMPUTED = 0.5, 0.95  # Progress once the trees, and the surface, are there.
_NOTES = """\
The meshes of one file count as one. With --object, the operands are these meshes, in this order.
Meshes may be open, leaky, and intersect themselves. Only positions and triangles are written;
materials and attributes need Blender.

examples:
  prefilter boolean bunny.ply armadillo.ply --operation difference -o bite.ply
  prefilter boolean scene.glb --object Body --object Hole -o body.stl"""


def add(commands: Any, purpose: str) -> None:
    """Adds the command."""
    notes = (*tables(BooleanSettings, *FLAGS), _NOTES)
    parser = cli_common.add_command(commands, "boolean", purpose, *notes)
    parser.add_argument(
        "files", metavar="FILE", nargs="+", help=f"the operands: {either(mesh_extensions.READABLE)}"
    )
    endings = either(mesh_extensions.WRITABLE)
    outputs.add_output(
        parser, "OUTPUT", f"the file to write: {endings}", is_required=True, destination="output"
    )
    parser.set_defaults(intermixed="files")
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="an operand; the first one is changed (default: each file is one)",
    )
    add_flags(parser, BooleanSettings, *FLAGS, exclusive=voxelize.RESOLUTIONS)
    parser.set_defaults(execute=_boolean, usage_error=parser.error)


class BooleanFile:
    """Combines meshes in one grid of cells and writes the result to a file."""

    def __init__(self, operands: list[NamedMesh], target: Path, settings: BooleanSettings) -> None:
        """Takes the meshes to combine, the file to write, and the settings."""
        self._operands = operands
        self._target = target
        self._settings = settings
        self._warnings: list[str] = []
        self._notes: list[str] = []
        self._line = ""
        self._staged: staging.StagedFile | None = None

    def compute(self, progress: Progress) -> None:
        """Voxelizes, combines, contours, and stages the file.

        Raises:
            ValueError: An operand encloses nothing, or nothing is left.
            MemoryError: A result does not fit into memory.
            OSError: The file cannot be written.
            prefilter.Cancelled: `progress` returned False.
        """
        settings = self._settings
        tree, sources, cells = self._combined(share(progress, 0.0, _VOXELIZED))
        positions, triangles, _ = surfaces.surface(
            tree,
            sources,
            settings,
            share(progress, _VOXELIZED, _COMPUTED),
            adaptivity=settings.adaptivity,
        )
        if len(triangles) == 0:
            raise NothingLeftError(NO_FILLED_CELL)
        name = self._operands[0].name
        others = listed(operand.name for operand in self._operands[1:])
        volume = measure_mesh(positions, triangles, threads=settings.threads).volume
        self._line = (
            f"{settings.operation.capitalize()} of '{name}' with {others} in {cells}³ cells: "
            f"{amount(len(triangles), 'triangle')}, volume {volume:.4g}"
        )
        result = [NamedMesh(name, positions, triangles, None)]
        self._staged = mesh_files.stage(self._target, result)
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the file into place."""
        assert self._staged is not None
        self._staged.commit()
        files = [str(self._target)]
        return Outcome(self._line, files=files, warnings=self._warnings, notes=self._notes)

    def discard(self) -> None:
        """Removes the staged file if it was not put into place."""
        if self._staged is not None:
            self._staged.discard()

    def _combined(self, progress: Progress) -> tuple[prefilter.Octree, list[tuple[Any, ...]], int]:
        """Returns the combined tree, its source meshes, and the number of cells along an axis."""
        settings = self._settings
        measures = [self._measured(operand) for operand in self._operands]
        grid = choose_grid(
            booleans.box([measure.box for measure in measures], settings.operation), settings
        )
        check_memory(grid, sum(measure.area for measure in measures))
        trees, sources = [], []
        steps = parts(progress, len(self._operands))
        for operand, part in zip(self._operands, steps, strict=True):
            try:
                occupancy = surfaces.occupancy(
                    operand.positions, operand.triangles, grid, settings, part
                )
            except ValueError as error:
                raise ValueError(f"mesh '{operand.name}': {error}") from error
            warnings, notes = surfaces.repair_lines(operand.name, occupancy)
            self._warnings += warnings
            self._notes += notes
            trees.append(occupancy.tree)
            sources.append((occupancy.positions, occupancy.triangles))
        tree = booleans.combined(
            trees, settings.operation, share(progress, 1.0, 1.0), settings.threads
        )
        return tree, sources, grid.cells

    def _measured(self, operand: NamedMesh) -> MeshMeasures:
        try:
            return measure_mesh(
                operand.positions, operand.triangles, threads=self._settings.threads
            )
        except ValueError as error:
            raise ValueError(f"mesh '{operand.name}': {error}") from error


def _boolean(options: argparse.Namespace) -> None:
    if len(options.files) < 2 and len(options.object) < 2:
        options.usage_error("FILE: give two files or more, or --object for two meshes or more")
    for path in options.files:
        cli_common.check_extension(options, "FILE", path, mesh_extensions.READABLE)
    check_output(options, mesh_extensions.WRITABLE)
    target = Path(os.path.realpath(options.output))
    staging.check_target(target)
    settings = voxelize.settings_of(options, PLAIN, BooleanSettings)
    cli_common.run_and_report(BooleanFile(_operands(options), target, settings))


def check_output(options: argparse.Namespace, allowed: Sequence[str]) -> None:
    """Ends the program if the file to write has an unknown extension, or is also read."""
    options.output = outputs.checked_path(options, "--output", options.output)
    cli_common.check_extension(options, "--output", options.output, allowed)
    outputs.check_not_replaced(options, [options.output], options.files)


def _operands(options: argparse.Namespace) -> list[NamedMesh]:
    groups = [mesh_files.read("FILE", [path]) for path in options.files]
    if options.object:
        meshes = [part for group in groups for part in group]
        named = [mesh_files.select(meshes, [name]) for name in options.object]
        operands = [as_one(parts[0].name, parts) for parts in named]
    else:
        names = [mesh_files.name_of(path) for path in options.files]
        operands = [as_one(name, group) for name, group in zip(names, groups, strict=True)]
    return [mesh_files.merge_seams(operand) for operand in operands]


def as_one(name: str, meshes: Sequence[NamedMesh]) -> NamedMesh:
    """Returns several meshes joined into one, without UVs."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    triangles = [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)]
    positions = np.concatenate([mesh.positions for mesh in meshes])
    return NamedMesh(name, positions, np.concatenate(triangles), None)
