# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `reconstruct`."""

import argparse
import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from .._border.staging import check_target
from .._options.flags import add_flags, given, tables
from .._options.scans import ScanSettings
from .._work.scans import STREAMED_TARGET, Streaming
from .._work.wording import either
from ..points.scan_files import POINT_EXTENSIONS
from . import telling
from .host import PLAIN, Host

_NOTES = """\
Several SOURCEs count as one cloud. Points without normals are read into memory, and their normals
are estimated. All other points are read, and the surface is written, piece by piece, so that
neither has to fit into memory; with --memory-limit, the rest goes to temporary files.

examples:
  prefilter reconstruct scan.ply surface.ply
  prefilter reconstruct city.laz city.ply --depth 11 --memory-limit 600
  prefilter reconstruct left.ply right.ply hall.ply --viewpoint 0 0 1.5 --viewpoint 8 0 1.5
  prefilter reconstruct tile.laz ground.ply --classes 2 --returns last --trim 8"""


def add(commands: Any, purpose: str) -> None:
    """Adds the command."""
    parser = telling.add_command(commands, "reconstruct", purpose, *tables(ScanSettings), _NOTES)
    add_files(parser, POINT_EXTENSIONS, (STREAMED_TARGET,))
    add_settings(parser, PLAIN)
    parser.set_defaults(execute=partial(_reconstruct, PLAIN), usage_error=parser.error)


def add_files(
    parser: argparse.ArgumentParser, sources: Sequence[str], targets: Sequence[str]
) -> None:
    """Adds the arguments that name files, of which these kinds are read and written."""
    parser.add_argument(
        "sources",
        metavar="SOURCE",
        nargs="+",
        help=f"a file of points: {either(sources)}; repeat for several",
    )
    parser.add_argument("target", metavar="TARGET", help=f"the file to write: {either(targets)}")
    parser.add_argument(
        "--viewpoint",
        nargs=3,
        type=float,
        action="append",
        metavar=("X", "Y", "Z"),
        help="where the scanner stood: normals point there; repeat for each SOURCE where that "
        "differs (default: what the files say)",
    )


def add_settings(parser: argparse.ArgumentParser, host: Host) -> None:
    """Adds the flags of settings."""
    host.add_preset(parser)
    sizes = ("depth", "voxel_size")
    add_flags(
        parser,
        ScanSettings,
        exclusive=sizes,
        without_default=(*sizes, "box"),
        preferred=host.preferred,
    )


def settings_of(options: argparse.Namespace, host: Host) -> ScanSettings:
    """Returns the settings that were given, with what follows from them."""
    found, more = given(options, ScanSettings), {}
    for name, resolution in (("depth", "depth"), ("voxel_size", "size")):
        if name in found:
            more["resolution"] = resolution
    if "custom_isovalue" in found:
        more["isovalue"] = "custom"
    settings: ScanSettings = host.settings(options, ScanSettings, **more)
    return settings


def _reconstruct(host: Host, options: argparse.Namespace) -> None:
    for path in options.sources:
        telling.check_ending(options, "SOURCE", path, POINT_EXTENSIONS)
    telling.check_ending(options, "TARGET", options.target, (STREAMED_TARGET,))
    target = Path(os.path.realpath(options.target))
    check_target(target)
    sources = [Path(path) for path in options.sources]
    settings = settings_of(options, host)
    work = Streaming(sources, target, settings, "{:.4g}".format, options.viewpoint)
    telling.tell(telling.done(work))
