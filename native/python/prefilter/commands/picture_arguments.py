# SPDX-License-Identifier: GPL-3.0-or-later

"""Arguments of `resize` and `resample`, which read and write pictures."""

import argparse
from pathlib import Path
from typing import Any

from ..workflows.files import pictures
from ..workflows.picture import Picture
from ..workflows.wording import either
from . import batch, cli_common, color_arguments, tasks
from .batch import Pair
from .host import Host

NOTE = """\
INPUT is a picture file of any kind. Colors are filtered as light, with alpha as coverage. PNG
files get 8 bits, or 16 where INPUT has more than 8, and straight alpha; OpenEXR files are
scene-linear, with premultiplied alpha. Gray pictures stay gray, and pictures that EXIF turns are
turned. PNG files keep the ICC profile of INPUT; other colors become sRGB in PNG files, and linear
Rec. 709 in OpenEXR files."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments that name the files."""
    batch.add_arguments(parser, ("INPUT", "OUTPUT"), "a picture file", either(pictures.ENDINGS))
    parser.add_argument(
        "--data",
        action="store_true",
        help="filter values as they are stored, each channel by itself: roughness, masks, normals",
    )
    color_arguments.add_flags(parser, "INPUT")
    tasks.add_flags(parser, "INPUT")
    cli_common.add_skip_flag(parser)


def result_settings(options: argparse.Namespace, host: Host, settings: type) -> dict[str, Any]:
    """Returns the settings that determine a command's result, besides the picture itself."""
    names = ("data", "colorspace", "clip", "corners", "rectify", "scale")
    return cli_common.result_settings(options, settings, *names, preset=host.preset(options))


def check_target(options: argparse.Namespace) -> None:
    """Ends the program unless OUTPUT has the extension of a picture file."""
    batch.resolve_files(options)
    cli_common.check_extension(options, "OUTPUT", options.target, pictures.ENDINGS)


def read_source(options: argparse.Namespace, host: Host, pair: Pair) -> tuple[Picture, Path]:
    """Returns the picture of INPUT, and the file to write."""
    target = pair.checked_target()
    is_png = target.suffix.lower() == ".png"
    picture = host.read(
        "INPUT",
        pair.source,
        is_data=options.data,
        colorspace=options.colorspace,
        keeps_chunks=is_png,
        keeps_bytes=is_png,
    )
    cli_common.warn(picture.reading_warnings)
    if is_png:
        color_arguments.check_range("INPUT", picture, target, options)
    return picture, target
