# SPDX-License-Identifier: GPL-3.0-or-later

"""What `resize` and `resample` read and write: a picture file each."""

import argparse
from pathlib import Path

from ...bridge import images
from ...bridge.files import pictures, staging
from ...bridge.images import Picture
from ...core import command
from ...core.wording import either
from ..new_picture import read

NOTE = """\
INPUT is any picture that Blender reads. Colors are filtered as light, with alpha as coverage. PNG
files get 8 bits, or 16 where INPUT has more than 8, and straight alpha; OpenEXR files are
scene-linear, with premultiplied alpha."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments that name the files."""
    parser.add_argument("source", metavar="INPUT", help="a picture file")
    parser.add_argument(
        "target", metavar="OUTPUT", help=f"the file to write: {either(pictures.ENDINGS)}"
    )
    parser.add_argument(
        "--data",
        action="store_true",
        help="filter values as they are stored, each channel by itself: roughness, masks, normals",
    )


def check_target(options: argparse.Namespace) -> None:
    """Ends the program unless OUTPUT has an extension of a picture."""
    command.check_ending(options, "OUTPUT", options.target, pictures.ENDINGS)


def read_source(options: argparse.Namespace) -> tuple[Picture, Path]:
    """Returns what INPUT has, and the file to write."""
    target = staging.check_output(options.target)
    return read(images.load("INPUT", options.source, is_data=options.data)), target
