"""The commands `voxelize` and `boolean`."""

import argparse
import math
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import bpy

from ..bridge.files import scenes, staging
from ..core import command
from ..core.wording import listed
from . import choices
from .boolean import Boolean
from .voxelization import Voxelization

_VOXELIZE_HELP = "make closed surfaces, or volumes, of any meshes, through voxels"
_BOOLEAN_HELP = "combine meshes by union, intersection or difference, through voxels"
_TABLE = command.table("interpolants", choices.INTERPOLANTS)
_VOXELIZE_NOTES = """\
Each object of FILE is voxelized by itself, with its modifiers and instances. Meshes may be open,
leaky, and intersect themselves.

examples:
  prefilter voxelize bunny.ply bunny.stl --depth 8
  prefilter voxelize scene.blend figure.glb --object Figure --voxel-size 0.01
  prefilter voxelize cloud.obj cloud.vdb --depth 9"""
_BOOLEAN_NOTES = """\
The objects of one file count as one. With --object, the operands are these objects, in this order.

examples:
  prefilter boolean bunny.ply armadillo.ply --operation difference --output bite.ply
  prefilter boolean scene.blend --object Body --object Hole --output scene.blend"""


def add(commands: Any) -> None:
    """Adds the commands."""
    _add_voxelize(commands)
    _add_boolean(commands)


def _add_voxelize(commands: Any) -> None:
    parser = command.add_command(commands, "voxelize", _VOXELIZE_HELP, _TABLE, _VOXELIZE_NOTES)
    parser.add_argument("file", metavar="FILE", help=f"a file: {_endings(_sources())}")
    parser.add_argument(
        "output", metavar="OUTPUT", help=f"the file to write: {_endings(_targets(volume=True))}"
    )
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="an object to voxelize; repeat for several (default: all that are visible)",
    )
    _add_common(parser)
    parser.set_defaults(execute=_voxelize, usage_error=parser.error)


def _add_boolean(commands: Any) -> None:
    parser = command.add_command(commands, "boolean", _BOOLEAN_HELP, _TABLE, _BOOLEAN_NOTES)
    parser.add_argument(
        "files", metavar="FILE", nargs="+", help=f"the operands: {_endings(_sources())}"
    )
    parser.add_argument(
        "--operation",
        choices=choices.OPERATIONS,
        default=choices.BooleanSettings.operation,
        help=f"what to keep (default: {choices.BooleanSettings.operation})",
    )
    parser.add_argument(
        "--output",
        "-o",
        metavar="FILE",
        required=True,
        help=f"the file to write: {_endings(_targets(volume=False))}",
    )
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="an operand; the first one gets the result (default: each file is one)",
    )
    _add_common(parser)
    parser.set_defaults(execute=_boolean, usage_error=parser.error)


def _add_common(parser: argparse.ArgumentParser) -> None:
    defaults = choices.VoxelSettings()
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--depth",
        metavar="N",
        type=_depth,
        help=f"2^N cells along an axis, 1 to {choices.MOST_DEPTH} (default: {defaults.depth})",
    )
    group.add_argument(
        "--voxel-size", metavar="LENGTH", type=_size, help="the side of a cell in world space"
    )
    parser.add_argument(
        "--interpolant",
        choices=choices.INTERPOLANTS,
        default=defaults.interpolant,
        metavar="NAME",
        help=f"how the surface runs through cells (default: {defaults.interpolant})",
    )
    parser.add_argument(
        "--no-close-holes",
        dest="use_close_holes",
        action="store_false",
        help="leave holes open; the surface ends in steps there",
    )
    parser.add_argument(
        "--no-cleanup",
        dest="use_cleanup",
        action="store_false",
        help="keep all triangles, slivers too",
    )
    parser.add_argument(
        "--no-materials",
        dest="use_materials",
        action="store_false",
        help="do not keep the materials of the nearest faces",
    )
    parser.add_argument(
        "--no-colors",
        dest="use_colors",
        action="store_false",
        help="do not keep the color attributes of the nearest points",
    )
    parser.add_argument(
        "--smooth-angle",
        metavar="DEGREES",
        type=_angle,
        default=math.degrees(defaults.smooth_angle),
        help="edges with a greater angle stay sharp; 0 shades flat (default: 30)",
    )
    command.add_threads(parser)


def _voxelize(options: argparse.Namespace) -> None:
    _check_endings(options, [options.file], "FILE", _sources())
    _check_endings(options, [options.output], "OUTPUT", _targets(volume=True))
    is_volume = options.output.lower().endswith(".vdb")
    target = staging.check_output(options.output)
    objects = _named(scenes.load([options.file])[0], options.object)
    settings = choices.VoxelizeSettings(
        output="volume" if is_volume else "mesh",
        filepath=str(target) if is_volume else "",
        **_common(options),
    )
    work = Voxelization.read(objects, settings, bpy.context.evaluated_depsgraph_get())
    outcome = command.done(work)
    if not is_volume:
        scenes.save(target, outcome.objects)
    command.tell(outcome)


def _boolean(options: argparse.Namespace) -> None:
    if len(options.files) < 2 and len(options.object) < 2:
        options.usage_error("FILE: give two files or more, or --object for two objects or more")
    _check_endings(options, options.files, "FILE", _sources())
    _check_endings(options, [options.output], "--output", _targets(volume=False))
    target = staging.check_output(options.output)
    groups = scenes.load(options.files)
    if options.object:
        operands = _named([obj for group in groups for obj in group], options.object)
    else:
        names = [Path(path).stem for path in options.files]
        operands = [scenes.as_one(name, group) for name, group in zip(names, groups, strict=True)]
    settings = choices.BooleanSettings(
        operation=options.operation, operands="hide", **_common(options)
    )
    work = Boolean.read(operands[0], operands[1:], settings, bpy.context.evaluated_depsgraph_get())
    outcome = command.done(work)
    scenes.save(target, outcome.objects)
    command.tell(outcome)


def _common(options: argparse.Namespace) -> dict[str, Any]:
    defaults = choices.VoxelSettings()
    return {
        "resolution": "depth" if options.voxel_size is None else "size",
        "depth": defaults.depth if options.depth is None else options.depth,
        "voxel_size": options.voxel_size or defaults.voxel_size,
        "interpolant": options.interpolant,
        "use_close_holes": options.use_close_holes,
        "use_cleanup": options.use_cleanup,
        "use_materials": options.use_materials,
        "use_colors": options.use_colors,
        "use_smooth": options.smooth_angle > 0.0,
        "smooth_angle": math.radians(options.smooth_angle),
        "threads": options.threads,
    }


def _named(objects: list[bpy.types.Object], names: Sequence[str]) -> list[bpy.types.Object]:
    by_name = {obj.name: obj for obj in objects}
    for name in names:
        if name not in by_name:
            raise ValueError(
                f"--object: found no object named '{name}' that has a surface and is visible; "
                f"there are {listed(by_name)}"
            )
    return [by_name[name] for name in dict.fromkeys(names)] if names else objects


def _check_endings(
    options: argparse.Namespace, paths: Sequence[str], name: str, allowed: Sequence[str]
) -> None:
    for path in paths:
        if os.path.splitext(path)[1].lower() not in allowed:
            options.usage_error(f"{name}: found '{path}'; allowed are {', '.join(allowed)}")


def _sources() -> tuple[str, ...]:
    return (".blend", *scenes.IMPORTERS)


def _targets(*, volume: bool) -> tuple[str, ...]:
    return (".blend", *scenes.EXPORTERS, *((".vdb",) if volume else ()))


def _endings(endings: Sequence[str]) -> str:
    return f"{', '.join(endings[:-1])} or {endings[-1]}"


def _number(text: str, is_allowed: Callable[[float], bool], needed: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not is_allowed(value):
        raise argparse.ArgumentTypeError(f"found '{text}'; {needed} is needed")
    return value


def _depth(text: str) -> int:
    most = choices.MOST_DEPTH
    value = int(text) if text.isdecimal() else 0
    if not 1 <= value <= most:
        raise argparse.ArgumentTypeError(f"found '{text}'; a number from 1 to {most} is needed")
    return value


def _size(text: str) -> float:
    least = choices.LEAST_SIZE
    return _number(text, lambda v: least <= v < math.inf, f"a number of at least {least:g}")


def _angle(text: str) -> float:
    return _number(text, lambda v: 0.0 <= v <= 180.0, "a number from 0 to 180")
