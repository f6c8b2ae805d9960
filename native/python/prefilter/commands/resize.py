# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `resize`."""

import argparse
from functools import partial
from typing import Any

from ..options.flags import add_flags, given, tables
from ..options.images import ResizeSettings
from ..workflows.images.resizing import Resizing
from . import batch, cli_common, picture_arguments
from .batch import Pair
from .host import PLAIN, Host

_SIZES = ("percent", "width", "height")
_NOTES = f"""\
{picture_arguments.NOTE}

examples:
  prefilter resize photo.png -o small.png --percent 25 --filter least-squares
  prefilter resize roughness.png -o roughness-1k.png --width 1024 --data --wrap repeat
  prefilter resize sky.exr -o sky-2k.exr --width 2048 --height 1024 --filter mitchell
  prefilter resize *.png -o 'half/{{name}}.png' --percent 50 --task 2/8"""


def add(commands: Any, purpose: str, host: Host = PLAIN) -> None:
    """Adds the command."""
    parser = cli_common.add_command(commands, "resize", purpose, *tables(ResizeSettings), _NOTES)
    picture_arguments.add_arguments(parser)
    host.add_preset(parser)
    add_flags(parser, ResizeSettings, without_default=_SIZES, preferred=host.preferred)
    parser.set_defaults(execute=partial(_resize, host), usage_error=parser.error)


def _resize(host: Host, options: argparse.Namespace) -> None:
    picture_arguments.check_target(options)
    values = given(options, ResizeSettings)
    sizes = [name for name in _SIZES if name in values]
    if not sizes and "size" not in host.preset(options):
        options.usage_error("no size: give --percent, --width or --height")
    if "percent" in sizes and len(sizes) > 1:
        options.usage_error("--percent: not allowed with --width and --height")
    result_settings = picture_arguments.result_settings(options, host, ResizeSettings)
    batch.run(options, partial(_resize_one, host, options, values, sizes), result_settings)


def _resize_one(
    host: Host, options: argparse.Namespace, values: dict[str, Any], sizes: list[str], pair: Pair
) -> None:
    picture, target = picture_arguments.read_source(options, host, pair)
    if sizes == ["height"]:
        height, width = picture.shape[:2]
        values = values | {"width": max(1, round(width * values["height"] / height))}
    more = {"width": values["width"]} if "width" in values else {}
    if sizes:
        more |= {
            "size": "percent" if sizes == ["percent"] else "pixels",
            "use_aspect": sizes == ["width"],
        }
    settings = host.settings(options, ResizeSettings, **more)
    work = Resizing(picture, settings, target=target)
    work.metadata = pair.metadata
    cli_common.run_and_report(work)
