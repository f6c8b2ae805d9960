# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `reconstruct`."""

import argparse
from pathlib import Path
from typing import Any

import bpy

from ..bridge.files import scenes, staging
from ..bridge.points import may_be_points
from ..core import command, presets
from ..core.flags import add_flags, given, tables
from ..core.wording import either
from .choices import ScanSettings
from .files import SOURCES, STREAMED_TARGET, FilesReconstruction, Streaming
from .properties import RECONSTRUCT
from .reconstruction import Reconstruction

_HELP = "make the surface of points that a scanner has measured"
_BLEND = ".blend"
_SOURCES = (*SOURCES, _BLEND)
_WANTED = "visible object with points and no faces"
_NOTES = """\
Several SOURCEs count as one cloud. Points without normals are read into memory, and their normals
are estimated. All other points are read, and surfaces are written to .ply files, piece by piece, so
that neither has to fit into memory; with --memory-limit, the rest goes to temporary files. For
other targets the surface is made in memory. In a .blend file, objects with points and no faces are
used.

examples:
  prefilter reconstruct scan.ply surface.ply
  prefilter reconstruct city.laz city.ply --depth 11 --memory-limit 600
  prefilter reconstruct left.ply right.ply both.glb --wavelet d4 --trim 4"""


def add(commands: Any) -> None:
    """Adds the command."""
    parser = command.add_command(commands, "reconstruct", _HELP, *tables(ScanSettings), _NOTES)
    parser.add_argument(
        "sources",
        metavar="SOURCE",
        nargs="+",
        help=f"a file of points: {either(_SOURCES)}; repeat for several",
    )
    parser.add_argument(
        "target", metavar="TARGET", help=f"the file to write: {either(scenes.TARGETS)}"
    )
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="an object of a .blend file; repeat for several (default: all that are visible)",
    )
    presets.add_flag(parser)
    add_flags(parser, ScanSettings, exclusive=("depth", "voxel_size"))
    parser.set_defaults(execute=_reconstruct, usage_error=parser.error)


def _reconstruct(options: argparse.Namespace) -> None:
    endings = [command.check_ending(options, "SOURCE", path, _SOURCES) for path in options.sources]
    ending = command.check_ending(options, "TARGET", options.target, scenes.TARGETS)
    has_blend = _BLEND in endings
    if has_blend and len(set(endings)) > 1:
        options.usage_error("SOURCE: .blend files cannot be combined with others")
    if options.object and not has_blend:
        options.usage_error("--object: only .blend files have objects")
    target = staging.check_output(options.target)
    settings = _settings(options)
    if has_blend:
        _from_objects(options, target, settings)
        return
    sources = [Path(path) for path in options.sources]
    work = Streaming if ending == STREAMED_TARGET else FilesReconstruction
    command.tell(command.done(work(sources, target, settings)))


def _from_objects(options: argparse.Namespace, target: Path, settings: ScanSettings) -> None:
    groups = scenes.load(options.sources, _is_wanted, _WANTED)
    objects = scenes.chosen([obj for group in groups for obj in group], options.object, _WANTED)
    work = Reconstruction.read(objects, objects[0], settings, bpy.context.evaluated_depsgraph_get())
    outcome = command.done(work)
    scenes.save(target, outcome.objects)
    command.tell(outcome)


def _is_wanted(obj: bpy.types.Object) -> bool:
    return may_be_points(obj) and obj.visible_get()


def _settings(options: argparse.Namespace) -> ScanSettings:
    """Returns the settings that were given, with what follows from them."""
    found, more = given(options, ScanSettings), {}
    for name, resolution in (("depth", "depth"), ("voxel_size", "size")):
        if name in found:
            more["resolution"] = resolution
    if "custom_isovalue" in found:
        more["isovalue"] = "custom"
    return presets.settings_given(options, RECONSTRUCT, ScanSettings, **more)
