# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `voxelize`."""

import argparse
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from ..files import staging
from ..meshes.measures import measure_mesh
from ..options.flags import add_flags, given, tables
from ..options.voxels import VoxelizeSettings, VoxelSettings
from ..workflows import mesh_extensions, mesh_files
from ..workflows.mesh_files import NamedMesh
from ..workflows.outcome import Outcome
from ..workflows.progress import Progress, go_on, parts, share
from ..workflows.up_to_date import MESHES
from ..workflows.voxels import surfaces
from ..workflows.voxels.empty_results import (
    NO_FILLED_CELL,
    EmptyResults,
    NothingLeftError,
    check_area,
)
from ..workflows.voxels.grid import check_memory, choose_grid
from ..workflows.wording import Sentence, amount, counted, either
from . import batch, cli_common, tasks
from .batch import Pair
from .host import PLAIN, Host

RESOLUTIONS = ("depth", "voxel_size")
FLAGS = (
    *(*RESOLUTIONS, "interpolant", "adaptivity", "thickness", "gap", "use_close_holes", "holes"),
    *("use_cleanup", "threads"),
)
"""The options that work without Blender."""
_VOXELIZED = 0.5  # Progress once there is a tree.
_COMPUTED = 0.95  # Progress once there are surfaces.
_NOTES = """\
Each mesh of FILE is voxelized by itself. Meshes may be open, leaky, and intersect themselves. Only
positions and triangles are written; materials and attributes need Blender.

examples:
  prefilter voxelize bunny.ply -o bunny.stl --depth 8
  prefilter voxelize scene.glb -o figure.glb --object Figure --voxel-size 0.01"""


def add(commands: Any, purpose: str) -> None:
    """Adds the command."""
    notes = (*tables(VoxelizeSettings, *FLAGS), _NOTES)
    parser = cli_common.add_command(commands, "voxelize", purpose, *notes)
    endings = either(mesh_extensions.READABLE), either(mesh_extensions.WRITABLE)
    batch.add_arguments(parser, ("FILE", "OUTPUT"), f"a file: {endings[0]}", endings[1])
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="a mesh to voxelize; repeat for several (default: all)",
    )
    add_flags(parser, VoxelizeSettings, *FLAGS, exclusive=RESOLUTIONS)
    tasks.add_flags(parser, "FILE")
    cli_common.add_skip_flag(parser)
    parser.set_defaults(execute=_voxelize, usage_error=parser.error)


def settings_of(
    options: argparse.Namespace, host: Host, settings: type[VoxelSettings], **more: Any
) -> Any:
    """Returns the given settings, with those that follow from them."""
    values = given(options, settings)
    for name, resolution in zip(RESOLUTIONS, ("depth", "size"), strict=True):
        if name in values:
            more["resolution"] = resolution
    if "smooth_angle" in values:
        more["use_smooth_shading"] = values["smooth_angle"] > 0.0
    return host.settings(options, settings, **more)


class VoxelFile:
    """Voxelizes each of several meshes and writes the results to a file."""

    def __init__(self, meshes: list[NamedMesh], target: Path, settings: VoxelizeSettings) -> None:
        """Takes the meshes to voxelize, the file to write, and the settings."""
        self.metadata: Mapping[str, str] | None = None
        """Key-value pairs to store in the file."""
        self._meshes = meshes
        self._target = target
        self._settings = settings
        self._warnings: list[str] = []
        self._notes: list[str] = []
        self._lines: list[str] = []
        self._triangles = 0
        self._staged: staging.StagedFile | None = None

    def compute(self, progress: Progress) -> None:
        """Voxelizes, contours, and stages the file.

        Raises:
            ValueError: The cells of a mesh are too small, or every mesh vanishes.
            MemoryError: A result does not fit into memory.
            OSError: The file cannot be written.
            prefilter.Cancelled: `progress` returned False.
        """
        steps = parts(share(progress, 0.0, _COMPUTED), len(self._meshes))
        results, left_out = [], EmptyResults()
        for mesh, part in zip(self._meshes, steps, strict=True):
            try:
                results.append(self._voxelized(mesh, part))
            except NothingLeftError as error:
                left_out.add(mesh.name, error)
            except ValueError as error:
                raise ValueError(f"mesh '{mesh.name}': {error}") from error
        self._warnings += left_out.warnings_for(results)
        go_on(progress, _COMPUTED)
        self._staged = mesh_files.stage(self._target, results, self.metadata)
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the file into place."""
        assert self._staged is not None
        self._staged.commit()
        summary, notes = Sentence("Voxelized {}", self._lines[0]), self._notes
        if len(self._lines) > 1:
            meshes, triangles = counted(self._lines, "object"), amount(self._triangles, "triangle")
            summary, notes = Sentence("Voxelized {}: {}", meshes, triangles), [*self._lines, *notes]
        return Outcome(summary, files=[str(self._target)], warnings=self._warnings, notes=notes)

    def discard(self) -> None:
        """Removes the staged file if it was not put into place."""
        if self._staged is not None:
            self._staged.discard()

    def _voxelized(self, mesh: NamedMesh, progress: Progress) -> NamedMesh:
        settings = self._settings
        measures = measure_mesh(mesh.positions, mesh.triangles, threads=settings.threads)
        check_area(measures.area)
        grid = choose_grid(measures.box, settings)
        check_memory(grid, measures.area)
        steps = share(progress, 0.0, _VOXELIZED)
        occupancy = surfaces.occupancy(mesh.positions, mesh.triangles, grid, settings, steps)
        positions, triangles, _ = surfaces.surface(
            occupancy.tree,
            [(occupancy.positions, occupancy.triangles)],
            settings,
            share(progress, _VOXELIZED, 1.0),
            adaptivity=settings.adaptivity,
        )
        if len(triangles) == 0:
            raise NothingLeftError(NO_FILLED_CELL)
        warnings, notes = surfaces.repair_lines(mesh.name, occupancy)
        self._warnings += warnings
        self._notes += notes
        self._triangles += len(triangles)
        volume = measure_mesh(positions, triangles, threads=settings.threads).volume
        self._lines.append(
            f"'{mesh.name}' in {grid.cells}³ cells of {grid.spacing:.4g}: "
            f"{amount(len(triangles), 'triangle')}, volume {volume:.4g}"
        )
        return NamedMesh(mesh.name, positions, triangles, None)


def _voxelize(options: argparse.Namespace) -> None:
    batch.resolve_files(options)
    for path in options.sources:
        cli_common.check_extension(options, "FILE", path, mesh_extensions.READABLE)
    cli_common.check_extension(options, "OUTPUT", options.target, mesh_extensions.WRITABLE)
    settings = settings_of(options, PLAIN, VoxelizeSettings)
    result_settings = cli_common.result_settings(options, VoxelizeSettings, "object")
    batch.run(options, partial(_voxelize_one, options, settings), result_settings, MESHES)


def _voxelize_one(options: argparse.Namespace, settings: VoxelizeSettings, pair: Pair) -> None:
    target = pair.checked_target()
    parts = mesh_files.select(mesh_files.read("FILE", [pair.source]), options.object)
    meshes = [mesh_files.merge_seams(part) for part in parts]
    work = VoxelFile(meshes, target, settings)
    work.metadata = pair.metadata
    cli_common.run_and_report(work)
