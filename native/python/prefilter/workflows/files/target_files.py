# SPDX-License-Identifier: GPL-3.0-or-later

"""Texture files to write: allowed extensions, and their properties.

Loads nothing slow, so that commands that find their files up to date start fast.
"""

import os
from pathlib import Path

from ...files import staging

_RENDERER_EXTENSIONS = (".exr", ".tif", ".tiff", ".tx")
# Extensions that `engines` writes; .png gets one file per level.
_WITH_FORMATS = (".dds", ".ktx2")
_OTHER_EXTENSIONS = (*_WITH_FORMATS, ".png")
_MOST_LEVELS = 31
EXTENSIONS = (*_RENDERER_EXTENSIONS, *_OTHER_EXTENSIONS)
"""Allowed extensions of texture files."""
NAME_PLACEHOLDER = "{name}"
"""Placeholder for the name of the input in an output path."""


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
    for file in files_of(target):
        staging.check_target(file)
    return target


def files_of(target: Path) -> list[Path]:
    """Returns the files that may be written for a target: one, or one per level."""
    if target.suffix.lower() != ".png":
        return [target]
    return [numbered(target, number) for number in range(_MOST_LEVELS)]


def numbered(target: Path, number: int) -> Path:
    """Returns the file of one level, where each has its own, with symbolic links resolved."""
    return Path(os.path.realpath(target.with_suffix(f".{number:02d}{target.suffix}")))


def has_formats(path: str) -> bool:
    """Tells whether files of this type have a choice of texel formats."""
    return path.lower().endswith(_WITH_FORMATS)


def has_supercompression(path: str) -> bool:
    """Tells whether files of this type can be supercompressed."""
    return path.lower().endswith(".ktx2")
