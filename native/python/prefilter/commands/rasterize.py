# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `rasterize`."""

import argparse
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from ..options.flags import add_flags, given, tables
from ..options.shapes import RasterizeSettings
from ..workflows import mesh_extensions, mesh_files
from ..workflows.files import pictures
from ..workflows.shapes.layers import Source, svg_drawing, uv_layers
from ..workflows.shapes.layouts import borders
from ..workflows.shapes.rasterizing import RasterFile
from ..workflows.up_to_date import is_self_contained
from ..workflows.wording import either
from . import batch, cli_common, tasks
from .batch import Pair
from .host import PLAIN, Host

SVG = ".svg"
"""The extension of drawings."""
_SOURCES = (SVG, *mesh_extensions.READABLE)
FLAGS = (
    *("filter", "side", "width", "height", "density", "margin", "tile", "uv_margin"),
    *("color", "background_color", "overlap", "light", "font_folder", "pixel_type", "alpha"),
    *("use_bleed", "threads"),
)
"""The options that need no Blender."""
_NOTES = """\
The image is as long as --side says, and as high or wide as the shapes are; with --width and
--height they are fitted into that, inside the margin; with --density, their size decides. PNG files
have 8 bits with --pixel-type byte, otherwise 16, and straight alpha; OpenEXR files are
scene-linear, with premultiplied alpha.

examples:
  prefilter rasterize logo.svg -o logo.png --side 512
  prefilter rasterize icons/*.svg -o '{name}.png' --side 64
  prefilter rasterize figure.glb -o mask.png --uv --object Body --width 2048 --height 2048"""


def add(commands: Any, purpose: str) -> None:
    """Adds the command."""
    notes = (*tables(RasterizeSettings, *FLAGS), _NOTES)
    parser = cli_common.add_command(commands, "rasterize", purpose, *notes)
    endings = either(_SOURCES), either(pictures.ENDINGS)
    batch.add_arguments(parser, ("INPUT", "OUTPUT"), f"a file: {endings[0]}", endings[1])
    parser.add_argument(
        "--object", metavar="NAME", help="with --uv, the mesh, if there are several"
    )
    parser.add_argument("--uv", action="store_true", help="make a mask of the UV map of a mesh")
    add_flags(parser, RasterizeSettings, *FLAGS)
    tasks.add_flags(parser, "INPUT")
    cli_common.add_skip_flag(parser)
    parser.set_defaults(execute=_rasterize, usage_error=parser.error)


def settings_of(options: argparse.Namespace, host: Host) -> RasterizeSettings:
    """Returns the given settings, with those that follow from them."""
    values = given(options, RasterizeSettings)
    more: dict[str, Any] = {}
    ways = {"width": "size", "height": "size", "density": "density", "side": "side"}
    chosen = {way: name for name, way in ways.items() if name in values}
    if len(chosen) > 1:
        options.usage_error("--side, --density, and --width with --height: only one of these")
    if chosen:
        (more["resolution"],) = chosen
    if options.uv and "side" in values:
        more["width"] = more["height"] = values["side"]
    if options.uv:
        more["color"] = "mask"
    if "background_color" in values:
        more["background"] = "color"
    settings: RasterizeSettings = host.settings(options, RasterizeSettings, **more)
    return settings


def _rasterize(options: argparse.Namespace) -> None:
    endings = check_files(options, _SOURCES)
    if endings != {SVG} and not options.uv:
        options.usage_error("--uv: needed for meshes")
    settings = settings_of(options, PLAIN)
    result_settings = cli_common.result_settings(options, RasterizeSettings, "object", "uv")
    process = partial(_rasterize_one, options, settings)
    batch.run(
        options,
        process,
        result_settings,
        may_skip=lambda path: options.uv or is_self_contained(path),
    )


def check_files(options: argparse.Namespace, allowed: Sequence[str]) -> set[str]:
    """Returns the extensions of the inputs; ends the program if the files do not fit the flags."""
    batch.resolve_files(options)
    endings = {
        cli_common.check_extension(options, "INPUT", path, allowed) for path in options.sources
    }
    cli_common.check_extension(options, "OUTPUT", options.target, pictures.ENDINGS)
    if SVG in endings and (options.uv or options.object):
        options.usage_error("--object, --uv: an SVG file has neither objects nor a UV map")
    return endings


def _rasterize_one(options: argparse.Namespace, settings: RasterizeSettings, pair: Pair) -> None:
    target = pair.checked_target()
    warnings: list[str] = []
    if not options.uv:
        source = svg_drawing("INPUT", pair.source)
    else:
        source = _layout(options, pair.source, settings, warnings)
    work = RasterFile(source, target, settings, warnings)
    work.metadata = pair.metadata
    cli_common.run_and_report(work)


def _layout(
    options: argparse.Namespace, path: str, settings: RasterizeSettings, warnings: list[str]
) -> Source:
    """Returns the UV map of the mesh; adds to the warnings where it has no area."""
    names = [options.object] if options.object else []
    meshes = mesh_files.select(mesh_files.read("INPUT", [path]), names)
    if len(meshes) > 1:
        options.usage_error(f"--object: choose one of the {len(meshes)} meshes; --uv takes one")
    (part,) = meshes
    if part.uvs is None:
        raise ValueError(f"mesh '{part.name}' has no UV map")
    _, uvs = part.mapped()
    if not np.isfinite(uvs).all():
        raise ValueError(f"mesh '{part.name}': the UV map has UVs that are not finite")
    polygons = borders(uvs.astype(np.float32))
    if not polygons:
        warnings.append(f"mesh '{part.name}': no face has an area in the UV map")
    return uv_layers(f"{part.name}.uv", polygons, settings)
