# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `reconstruct`."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
from prefilter.commands import reconstruct
from prefilter.commands.program import COMMANDS
from prefilter.points.extensions import POINT_EXTENSIONS
from prefilter.workflows.points import STREAMED_TARGET, Streaming

from ..bridge.files import scenes
from ..bridge.points import may_be_points
from ..bridge.units import length
from ..core import command, presets
from ..core.flags import tables
from .choices import ScanSettings
from .files import FilesReconstruction, move_back
from .properties import RECONSTRUCT
from .reconstruction import ObjectsReconstruction, ObjectsStreaming

_BLEND = ".blend"
_SOURCES = (*POINT_EXTENSIONS, _BLEND)
_WANTED = "visible object with points and no faces"
_NOTES = """\
Several SOURCEs count as one cloud. Points without normals are read into memory, and their normals
are estimated. All other points are read, and surfaces are written to .ply files, piece by piece, so
that neither has to fit into memory; with --memory-limit, the rest goes to temporary files. For
other targets the surface is made in memory. In a .blend file, objects with points and no faces are
used.

examples:
  prefilter reconstruct scan.ply -o surface.ply
  prefilter reconstruct city.laz -o city.ply --depth 11 --memory-limit 600
  prefilter reconstruct left.ply right.ply -o both.glb --wavelet d4 --trim 4"""


def add(commands: Any) -> None:
    """Adds the command."""
    notes = (*tables(ScanSettings), _NOTES)
    parser = command.add_command(commands, "reconstruct", COMMANDS["reconstruct"], *notes)
    reconstruct.add_files(parser, _SOURCES, scenes.TARGETS)
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="an object of a .blend file; repeat for several (default: all that are visible)",
    )
    reconstruct.add_settings(parser, presets.host(RECONSTRUCT))
    reconstruct.add_steps(parser)
    parser.set_defaults(execute=_reconstruct, usage_error=parser.error)


def _reconstruct(options: argparse.Namespace) -> None:
    reconstruct.resolve_files(options)
    endings = [
        command.check_extension(options, "SOURCE", path, _SOURCES) for path in options.sources
    ]
    ending = command.check_extension(options, "TARGET", options.target, scenes.TARGETS)
    has_blend = _BLEND in endings
    if has_blend and len(set(endings)) > 1:
        options.usage_error("SOURCE: .blend files cannot be combined with others")
    if options.object and not has_blend:
        options.usage_error("--object: only .blend files have objects")
    if options.viewpoint and has_blend:
        options.usage_error("--viewpoint: objects of .blend files have their own")
    reconstruct.check_steps(options)
    if options.step is not None and ending != STREAMED_TARGET:
        options.usage_error(f"--step: needs a {STREAMED_TARGET} file as TARGET")
    if options.step is not None and has_blend:
        options.usage_error("--step: not allowed for .blend files")
    target = scenes.check_target(options.target)
    settings = reconstruct.settings_of(options, presets.host(RECONSTRUCT))
    if has_blend:
        _from_objects(options, target, settings)
        return
    if options.step is not None:
        reconstruct.do_step(options, target, settings, length)
        return
    sources = [Path(path) for path in options.sources]
    if ending == STREAMED_TARGET:
        command.run_and_report(Streaming(sources, target, settings, length, options.viewpoint))
        return
    command.run_and_report(FilesReconstruction(sources, target, settings, options.viewpoint))


def _from_objects(options: argparse.Namespace, target: Path, settings: ScanSettings) -> None:
    groups = scenes.load(options.sources, _is_wanted, _WANTED)
    objects = scenes.chosen([obj for group in groups for obj in group], options.object, _WANTED)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    work = ObjectsReconstruction.read(objects, objects[0], settings, depsgraph)
    if target.suffix.lower() == STREAMED_TARGET and work.offset.any():
        command.run_and_report(ObjectsStreaming(work, target))
        return
    outcome = command.run_work(work)
    warnings = []
    for name in outcome.objects:
        warnings += move_back(bpy.data.objects[name], work.offset, target)
    scenes.save(target, outcome.objects)
    command.report_outcome(replace(outcome, warnings=[*outcome.warnings, *warnings]))


def _is_wanted(obj: bpy.types.Object) -> bool:
    return may_be_points(obj) and obj.visible_get()
