# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `resize`."""

import argparse
from typing import Any

from ...core import command, presets
from ...core.flags import add_flags, given, tables
from ..choices import ResizeSettings
from ..properties import RESIZE
from ..resizing import Resizing
from . import files

_HELP = "make a picture larger or smaller"
_SIZES = ("percent", "width", "height")
_NOTES = f"""\
{files.NOTE}

examples:
  prefilter resize photo.png small.png --percent 25 --filter least-squares
  prefilter resize roughness.png roughness-1k.png --width 1024 --data --wrap repeat
  prefilter resize sky.exr sky-2k.exr --width 2048 --height 1024 --filter mitchell"""


def add(commands: Any) -> None:
    """Adds the command."""
    parser = command.add_command(commands, "resize", _HELP, *tables(ResizeSettings), _NOTES)
    files.add_arguments(parser)
    presets.add_flag(parser)
    add_flags(parser, ResizeSettings, without_default=_SIZES)
    parser.set_defaults(execute=_resize, usage_error=parser.error)


def _resize(options: argparse.Namespace) -> None:
    files.check_target(options)
    found = given(options, ResizeSettings)
    sizes = [name for name in _SIZES if name in found]
    if not sizes and "size" not in presets.values_named(options, RESIZE):
        options.usage_error("no size: give --percent, --width or --height")
    if "percent" in sizes and len(sizes) > 1:
        options.usage_error("--percent: not allowed with --width and --height")
    picture, target = files.read_source(options)
    if sizes == ["height"]:
        height, width = picture.shape[:2]
        found["width"] = max(1, round(width * found["height"] / height))
    more = {"width": found["width"]} if "width" in found else {}
    if sizes:
        more |= {
            "size": "percent" if sizes == ["percent"] else "pixels",
            "use_aspect": sizes == ["width"],
        }
    settings = presets.settings_given(options, RESIZE, ResizeSettings, **more)
    command.tell(command.done(Resizing(picture, settings, target=target)))
