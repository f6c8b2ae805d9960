# SPDX-License-Identifier: GPL-3.0-or-later

"""The commands `voxelize` and `boolean`."""

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import bpy
from prefilter.commands import batch, boolean, outputs, tasks, voxelize
from prefilter.commands.batch import Pair
from prefilter.commands.program import COMMANDS
from prefilter.commands.voxelize import RESOLUTIONS
from prefilter.workflows.up_to_date import KEY, MESHES

from ..bridge.files import scenes
from ..bridge.new_meshes import is_solid
from ..core import command, presets
from ..core.flags import add_flags, given, tables
from ..core.wording import either
from . import memory
from .boolean import Boolean
from .choices import BooleanSettings, VoxelizeSettings
from .properties import BOOLEAN, VOXELIZE
from .voxelization import Voxelization

_WANTED = "visible object with a surface"
_VOLUME = ".vdb"
_TARGETS = (*scenes.TARGETS, _VOLUME)
_VOXELIZE_NOTES = """\
Each object of FILE is voxelized by itself, with its modifiers and instances. Meshes may be open,
leaky, and intersect themselves.

examples:
  prefilter voxelize bunny.ply -o bunny.stl --depth 8
  prefilter voxelize scene.blend -o figure.glb --object Figure --voxel-size 0.01
  prefilter voxelize cloud.obj -o cloud.vdb --depth 9"""
_BOOLEAN_NOTES = """\
The objects of one file count as one. With --object, the operands are these objects, in this order.

examples:
  prefilter boolean bunny.ply armadillo.ply --operation difference -o bite.ply
  prefilter boolean scene.blend --object Body --object Hole -o scene.blend --overwrite"""


def add(commands: Any) -> None:
    """Adds the commands."""
    _add_voxelize(commands)
    _add_boolean(commands)


def _add_voxelize(commands: Any) -> None:
    notes = (*tables(VoxelizeSettings), _VOXELIZE_NOTES)
    parser = command.add_command(commands, "voxelize", COMMANDS["voxelize"], *notes)
    endings = either(scenes.SOURCES), either(_TARGETS)
    batch.add_arguments(parser, ("FILE", "OUTPUT"), f"a file: {endings[0]}", endings[1])
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="an object to voxelize; repeat for several (default: all that are visible)",
    )
    presets.add_flag(parser)
    add_flags(parser, VoxelizeSettings, exclusive=RESOLUTIONS)
    tasks.add_flags(parser, "FILE")
    command.add_skip_flag(parser)
    parser.set_defaults(execute=_voxelize, usage_error=parser.error)


def _add_boolean(commands: Any) -> None:
    parser = command.add_command(
        commands, "boolean", COMMANDS["boolean"], *tables(BooleanSettings), _BOOLEAN_NOTES
    )
    parser.add_argument(
        "files", metavar="FILE", nargs="+", help=f"the operands: {either(scenes.SOURCES)}"
    )
    outputs.add_output(
        parser,
        "OUTPUT",
        f"the file to write: {either(scenes.TARGETS)}",
        is_required=True,
        destination="output",
    )
    parser.set_defaults(intermixed="files")
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="an operand; the first one gets the result (default: each file is one)",
    )
    presets.add_flag(parser)
    add_flags(parser, BooleanSettings, exclusive=RESOLUTIONS)
    parser.set_defaults(execute=_boolean, usage_error=parser.error)


def _voxelize(options: argparse.Namespace) -> None:
    batch.resolve_files(options)
    for path in options.sources:
        command.check_extension(options, "FILE", path, scenes.SOURCES)
    ending = command.check_extension(options, "OUTPUT", options.target, _TARGETS)
    if options.skip_up_to_date:
        command.check_stores_fingerprint(options, options.target, MESHES)
    batch.run(options, partial(_voxelize_one, options, is_volume=ending == _VOLUME))


def _voxelize_one(options: argparse.Namespace, pair: Pair, *, is_volume: bool) -> None:
    target = scenes.check_target(pair.target)
    (objects,) = scenes.load([pair.source], _is_wanted, _WANTED)
    more = {"output": "volume", "filepath": str(target)} if is_volume else {}
    work = Voxelization.read(
        scenes.chosen(objects, options.object, _WANTED),
        voxelize.settings_of(options, presets.host(VOXELIZE), VoxelizeSettings, **more),
        bpy.context.evaluated_depsgraph_get(),
    )
    files = scenes.decisive_files(pair.source) if options.skip_up_to_date else None
    metadata = {}
    if files is not None:
        metadata[KEY] = work.inputs(files)
        is_whole = not target.exists() or all(map(Path.is_file, scenes.material_files(target)))
        if is_whole and command.are_up_to_date([target], metadata[KEY]):
            return
    outcome = command.run_work(work)
    if not is_volume:
        scenes.save(target, outcome.objects, metadata)
    command.report_outcome(outcome)


def _boolean(options: argparse.Namespace) -> None:
    if len(options.files) < 2 and len(options.object) < 2:
        options.usage_error("FILE: give two files or more, or --object for two objects or more")
    for path in options.files:
        command.check_extension(options, "FILE", path, scenes.SOURCES)
    boolean.check_output(options, scenes.TARGETS)
    target = scenes.check_target(options.output)
    groups = scenes.load(options.files, _is_wanted, _WANTED)
    if options.object:
        objects = [obj for group in groups for obj in group]
        operands = scenes.chosen(objects, options.object, _WANTED)
    else:
        names = [Path(path).stem for path in options.files]
        operands = [scenes.as_one(name, group) for name, group in zip(names, groups, strict=True)]
    host = presets.host(BOOLEAN)
    settings: BooleanSettings = voxelize.settings_of(
        options, host, BooleanSettings, operands="hide"
    )
    if not (options.preset or given(options, BooleanSettings).keys() & set(RESOLUTIONS)):
        settings = memory.with_same_cells(operands[0], settings)
    else:
        settings = replace(settings, use_keep_resolution=False)
    work = Boolean.read(operands[0], operands[1:], settings, bpy.context.evaluated_depsgraph_get())
    outcome = command.run_work(work)
    scenes.save(target, outcome.objects)
    command.report_outcome(outcome)


def _is_wanted(obj: bpy.types.Object) -> bool:
    return is_solid(obj) and obj.visible_get()
