# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `resize`."""

import argparse
from typing import Any

from ...bridge import images
from ...bridge.files import pictures, staging
from ...core import command, presets
from ...core.flags import add_flags, given, tables
from ...core.wording import either
from ..choices import ResizeSettings
from ..new_picture import read
from ..properties import RESIZE
from ..resizing import Resizing

_HELP = "make a picture larger or smaller"
_SIZES = ("percent", "width", "height")
_NOTES = """\
INPUT is any picture that Blender reads. Colors are filtered as light, with alpha as coverage. PNG
files get 8 bits, or 16 where INPUT has more than 8, and straight alpha; OpenEXR files are
scene-linear, with premultiplied alpha.

examples:
  prefilter resize photo.png small.png --percent 25 --filter least-squares
  prefilter resize roughness.png roughness-1k.png --width 1024 --data --wrap repeat
  prefilter resize sky.exr sky-2k.exr --width 2048 --height 1024 --filter mitchell"""


def add(commands: Any) -> None:
    """Adds the command."""
    parser = command.add_command(commands, "resize", _HELP, *tables(ResizeSettings), _NOTES)
    parser.add_argument("source", metavar="INPUT", help="a picture file")
    parser.add_argument(
        "target", metavar="OUTPUT", help=f"the file to write: {either(pictures.ENDINGS)}"
    )
    parser.add_argument(
        "--data",
        action="store_true",
        help="filter values as they are stored, each channel by itself: roughness, masks, normals",
    )
    presets.add_flag(parser)
    add_flags(parser, ResizeSettings, without_default=_SIZES)
    parser.set_defaults(execute=_resize, usage_error=parser.error)


def _resize(options: argparse.Namespace) -> None:
    command.check_ending(options, "OUTPUT", options.target, pictures.ENDINGS)
    found = given(options, ResizeSettings)
    sizes = [name for name in _SIZES if name in found]
    if not sizes and "size" not in presets.values_named(options, RESIZE):
        options.usage_error("no size: give --percent, --width or --height")
    if "percent" in sizes and len(sizes) > 1:
        options.usage_error("--percent: not allowed with --width and --height")
    target = staging.check_output(options.target)
    picture = read(images.load("INPUT", options.source, is_data=options.data))
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
