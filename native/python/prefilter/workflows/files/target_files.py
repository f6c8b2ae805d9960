# SPDX-License-Identifier: GPL-3.0-or-later

"""Where textures are written to: which files there may be, and what their names say of them.

A command that finds its files up to date needs no more of them, so this loads nothing slow.
"""

import os
from pathlib import Path

from ...files import staging

_OF_RENDERERS = (".exr", ".tif", ".tiff", ".tx")
# Those that `engines` writes; the last one gets a file a level.
_WITH_FORMATS = (".dds", ".ktx2")
_OTHER_EXTENSIONS = (*_WITH_FORMATS, ".png")
_MOST_LEVELS = 31
EXTENSIONS = (*_OF_RENDERERS, *_OTHER_EXTENSIONS)
"""Those that a texture file may have."""
PLACE = "{name}"
"""What stands for the name of what is read in the path of what is written."""


def check_target(path: str) -> Path:
    """Returns the absolute path of a texture file that can be written, symbolic links resolved.

    Raises:
        ValueError: The name does not end in a known extension.
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    extension = target.suffix.lower()
    if extension not in EXTENSIONS:
        raise ValueError(
            f"file '{path}': unsupported extension '{target.suffix}'; use {', '.join(EXTENSIONS)}"
        )
    for file in written(target):
        staging.check_target(file)
    return target


def written(target: Path) -> list[Path]:
    """Returns the files that may be written for a target: one, or one a level."""
    if target.suffix.lower() != ".png":
        return [target]
    return [numbered(target, number) for number in range(_MOST_LEVELS)]


def numbered(target: Path, number: int) -> Path:
    """Returns the file of a level where each has its own, symbolic links resolved."""
    return Path(os.path.realpath(target.with_suffix(f".{number:02d}{target.suffix}")))


def has_formats(path: str) -> bool:
    """Tells whether there is a choice of formats for such a file."""
    return path.lower().endswith(_WITH_FORMATS)


def has_supercompression(path: str) -> bool:
    """Tells whether such a file may be supercompressed."""
    return path.lower().endswith(".ktx2")
