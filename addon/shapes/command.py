# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `rasterize`."""

import argparse
from functools import partial
from pathlib import Path
from typing import Any

import bpy
from prefilter.commands import batch, rasterize, tasks
from prefilter.commands.batch import Pair
from prefilter.commands.program import COMMANDS
from prefilter.commands.rasterize import SVG
from prefilter.workflows.files import pictures
from prefilter.workflows.up_to_date import KEY, PICTURES

from ..bridge.curves import is_curve
from ..bridge.files import scenes
from ..bridge.uv_layouts import has_uv_map
from ..core import command, presets
from ..core.flags import add_flags, tables
from ..core.wording import either
from .choices import RasterizeSettings
from .properties import RASTERIZE
from .provenance import Request
from .rasterization import Rasterization

_SOURCES = (SVG, *scenes.SOURCES)
_CURVES = "visible curve or text"
_MESHES = "visible mesh with a UV map"
_NOTES = """\
From files other than .svg, all visible curves and texts are used, or with --uv one mesh. The image
is as long as --side says, and as high or wide as the shapes are; with --width and --height they are
fitted into that, inside the margin; with --density, their size decides. PNG files have 8 bits
with --pixel-type byte, otherwise 16, and straight alpha; OpenEXR files are scene-linear, with
premultiplied alpha.

examples:
  prefilter rasterize logo.svg -o logo.png --side 512
  prefilter rasterize sign.blend -o sign.exr --object Text --density 400 --filter mitchell
  prefilter rasterize figure.glb -o mask.png --uv --object Body --width 2048 --height 2048"""


def add(commands: Any) -> None:
    """Adds the command."""
    parser = command.add_command(
        commands, "rasterize", COMMANDS["rasterize"], *tables(RasterizeSettings), _NOTES
    )
    extensions = either(_SOURCES), either(pictures.ENDINGS)
    batch.add_arguments(parser, ("INPUT", "OUTPUT"), f"a file: {extensions[0]}", extensions[1])
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="a curve or text, or with --uv the mesh; repeat for several (default: all visible "
        "curves and texts)",
    )
    parser.add_argument("--uv", action="store_true", help="make a mask of the UV map of a mesh")
    presets.add_flag(parser)
    add_flags(parser, RasterizeSettings)
    tasks.add_flags(parser, "INPUT")
    command.add_skip_flag(parser)
    parser.set_defaults(execute=_rasterize, usage_error=parser.error)


def _rasterize(options: argparse.Namespace) -> None:
    rasterize.check_files(options, _SOURCES)
    if options.skip_up_to_date:
        command.check_stores_fingerprint(options, options.target, PICTURES)
    settings = rasterize.settings_of(options, presets.host(RASTERIZE))
    batch.run(options, partial(_rasterize_one, options, settings))


def _rasterize_one(options: argparse.Namespace, settings: RasterizeSettings, pair: Pair) -> None:
    target = pair.checked_target()
    if pair.source.lower().endswith(SVG):
        request = Request("svg", filepath=str(Path(pair.source).absolute()))
    elif options.uv:
        request = Request("uv", [_mesh(options, pair.source)])
    else:
        (objects,) = scenes.load([pair.source], _is_wanted(is_curve), _CURVES)
        request = Request("curves", scenes.chosen(objects, options.object, _CURVES))
    work = Rasterization.read(request, settings, bpy.context, target=target)
    fingerprint = work.fingerprint() if options.skip_up_to_date else None
    if fingerprint is not None:
        if command.are_up_to_date([target], fingerprint):
            return
        work.metadata = {KEY: fingerprint}
    command.run_and_report(work)


def _mesh(options: argparse.Namespace, path: str) -> bpy.types.Object:
    (objects,) = scenes.load([path], _is_wanted(has_uv_map), _MESHES)
    meshes = scenes.chosen(objects, options.object, _MESHES)
    if len(meshes) > 1:
        options.usage_error(f"--object: choose one of the {len(meshes)} meshes; --uv takes one")
    return meshes[0]


def _is_wanted(is_kind: Any) -> Any:
    return lambda obj: is_kind(obj) and obj.visible_get()
