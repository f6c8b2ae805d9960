# SPDX-License-Identifier: GPL-3.0-or-later

"""Flags for the color space of a picture, and for its colors outside of sRGB."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..workflows import space_names

if TYPE_CHECKING:
    from ..workflows.picture import Picture


def add_flags(parser: argparse.ArgumentParser, thing: str) -> None:
    """Adds flags for the color space of a picture, and for clipping its colors."""
    parser.add_argument(
        "--colorspace",
        metavar="NAME",
        type=_space_name,
        default=space_names.AUTO,
        help=f"the color space of {thing}, whatever the file says: "
        f"{', '.join(space_names.EXAMPLES)}, or a name of the Color Interop Forum such as "
        f"lin_ap1_scene (default: {space_names.AUTO})",
    )
    parser.add_argument(
        "--clip",
        action="store_true",
        help=f"where {thing} is in another color space, let colors outside of sRGB become the "
        "nearest ones that the file can hold; without this flag they are refused",
    )


def _space_name(name: str) -> str:
    try:
        return space_names.checked_name(name)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def check_range(
    argument: str, picture: "Picture", target: Path, options: argparse.Namespace
) -> None:
    """Raises ValueError if a file would clip colors of a picture and --clip is not given."""
    if picture.outside > 0.0 and not options.clip:
        raise ValueError(
            f"{argument}: {100 * picture.outside:.3g} % of the pixels of '{picture.name}' have "
            f"colors outside of sRGB, which '{target.name}' cannot hold; write an .exr file, or "
            f"clip them by --clip"
        )
