# SPDX-License-Identifier: GPL-3.0-or-later

"""What `resize` and `resample` read and write: picture files."""

import argparse
from pathlib import Path
from typing import Any

from .._work import color_spaces
from .._work.files import pictures
from .._work.picture import Picture
from .._work.wording import either
from . import many, tasks, telling
from .host import Host
from .many import Pair

NOTE = """\
INPUT is a picture file of any kind. Colors are filtered as light, with alpha as coverage. PNG
files get 8 bits, or 16 where INPUT has more than 8, and straight alpha; OpenEXR files are
scene-linear, with premultiplied alpha. Gray pictures stay gray, and pictures that EXIF turns are
turned. PNG files keep the ICC profile of INPUT; other colors become sRGB in PNG files, and linear
Rec. 709 in OpenEXR files."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments that name the files."""
    many.add_arguments(parser, ("INPUT", "OUTPUT"), "a picture file", either(pictures.ENDINGS))
    parser.add_argument(
        "--data",
        action="store_true",
        help="filter values as they are stored, each channel by itself: roughness, masks, normals",
    )
    add_color_flags(parser, "INPUT")
    tasks.add_flags(parser, "INPUT")
    telling.add_skipping(parser)


def add_color_flags(parser: argparse.ArgumentParser, thing: str) -> None:
    """Adds the flags that say which colors a picture has, and what becomes of some.

    Args:
        parser: Gets them.
        thing: What the picture is called.
    """
    parser.add_argument(
        "--colorspace",
        metavar="NAME",
        type=_space_name,
        default=color_spaces.AUTO,
        help=f"the color space of {thing}, whatever the file says: "
        f"{', '.join(color_spaces.EXAMPLES)}, or a name of the Color Interop Forum such as "
        f"lin_ap1_scene (default: {color_spaces.AUTO})",
    )
    parser.add_argument(
        "--clip",
        action="store_true",
        help=f"where {thing} is in another color space, let colors outside of sRGB become the "
        "nearest ones that the file can hold; without this flag they are refused",
    )


def _space_name(name: str) -> str:
    try:
        return color_spaces.checked_name(name)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def check_range(argument: str, picture: Picture, target: Path, options: argparse.Namespace) -> None:
    """Raises ValueError where a file would lose colors of a picture, and nothing says it may.

    Args:
        argument: What the picture is called in messages.
        picture: The picture.
        target: A file that holds no colors outside of sRGB.
        options: The arguments.
    """
    if picture.outside > 0.0 and not options.clip:
        raise ValueError(
            f"{argument}: {100 * picture.outside:.3g} % of the pixels of '{picture.name}' have "
            f"colors outside of sRGB, which '{target.name}' cannot hold; write an .exr file, or "
            f"clip them by --clip"
        )


def decisive(options: argparse.Namespace, host: Host, settings: type) -> dict[str, Any]:
    """Returns all that decides what a command makes of a picture, but for the picture itself.

    Args:
        options: The arguments.
        host: Where the command runs.
        settings: The dataclass of its options.
    """
    names = ("data", "colorspace", "clip", "corners", "rectify", "scale")
    return telling.decisive(options, settings, *names, preset=host.preset(options))


def check_target(options: argparse.Namespace) -> None:
    """Ends the program unless OUTPUT has an extension of a picture."""
    telling.check_ending(options, "OUTPUT", options.target, pictures.ENDINGS)


def read_source(options: argparse.Namespace, host: Host, pair: Pair) -> tuple[Picture, Path]:
    """Returns what an INPUT has, and the file to write."""
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
    if is_png:
        check_range("INPUT", picture, target, options)
    return picture, target
