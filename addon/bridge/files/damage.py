# SPDX-License-Identifier: GPL-3.0-or-later

"""Damaged files: checks before loading, and reasons after a failure.

Some of Blender's importers crash the whole program on truncated files.
"""

import os
from pathlib import Path

from prefilter.workflows.damage import check_ply, damaged
from prefilter.workflows.up_to_date import referred_files

_MOST_HEADER = 1 << 16
_STL_HEADER, _STL_TRIANGLE = 84, 50


def check(path: str) -> None:
    """Raises OSError for a file that is empty, or would crash Blender's importer."""
    size = os.path.getsize(path)
    ending = Path(path).suffix.lower()
    if size == 0 or (ending == ".stl" and not _is_stl(path, size)):
        raise OSError(f"FILE: cannot load '{path}': {damaged(path, 'its contents are too short')}")
    if ending == ".ply":
        try:
            check_ply(path)
        except ValueError as error:
            raise OSError(f"FILE: {error}") from error


def why(path: str, error: BaseException) -> str:
    """Returns why Blender could not load a file, as a readable reason."""
    for other in referred_files(Path(path)):
        if not other.is_file():
            return f"the file '{other.name}' beside it is missing"
    if Path(path).suffix.lower() == ".blend":
        reason = damaged(path, str(error))
        return f"{reason}, or of a Blender that is much newer"
    return damaged(path, str(error))


def _is_stl(path: str, size: int) -> bool:
    """Whether an STL file is text, or a binary file of the right size for its triangles."""
    with open(path, "rb") as file:
        start = file.read(_MOST_HEADER)
    count = int.from_bytes(start[80:84], "little")
    return b"facet" in start or size == _STL_HEADER + count * _STL_TRIANGLE
