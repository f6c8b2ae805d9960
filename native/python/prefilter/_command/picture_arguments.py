# SPDX-License-Identifier: GPL-3.0-or-later

"""What `resize` and `resample` read and write: a picture file each."""

import argparse
import os
from pathlib import Path

from .._border.staging import check_target as check_writable
from .._work.files import pictures
from .._work.picture import Picture
from .._work.wording import either
from . import telling
from .host import Host

NOTE = """\
INPUT is a picture file of any kind. Colors are filtered as light, with alpha as coverage. PNG
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
    telling.check_ending(options, "OUTPUT", options.target, pictures.ENDINGS)


def read_source(options: argparse.Namespace, host: Host) -> tuple[Picture, Path]:
    """Returns what INPUT has, and the file to write."""
    target = Path(os.path.realpath(options.target))
    check_writable(target)
    return host.read("INPUT", options.source, is_data=options.data), target
