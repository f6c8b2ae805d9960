# SPDX-License-Identifier: GPL-3.0-or-later

"""Files that Blender must not get, or cannot load, and why.

Blender ends as a whole where some of its importers find a file cut off.
"""

import os
from pathlib import Path

from prefilter._work.damage import damaged
from prefilter._work.up_to_date import referred_files

from .ply_check import is_whole as is_whole_ply

_MOST_HEADER = 1 << 16
_STL_HEADER, _STL_TRIANGLE = 84, 50


def check(path: str) -> None:
    """Raises OSError for a file that is empty, or of which Blender's importer would not return."""
    with open(path, "rb") as file:
        start = file.read(_MOST_HEADER)
    size = os.path.getsize(path)
    ending = Path(path).suffix.lower()
    is_whole = size > 0
    if ending == ".ply":
        is_whole = is_whole_ply(Path(path))
    elif ending == ".stl":
        count = int.from_bytes(start[80:84], "little")
        is_whole = b"facet" in start or (
            len(start) >= _STL_HEADER and size == _STL_HEADER + count * _STL_TRIANGLE
        )
    if not is_whole:
        raise OSError(f"FILE: cannot load '{path}': {damaged(path, 'its contents are too short')}")


def why(path: str, error: BaseException) -> str:
    """Returns why Blender could not load a file, in our own words."""
    for other in referred_files(Path(path)):
        if not other.is_file():
            return f"the file '{other.name}' beside it is missing"
    if Path(path).suffix.lower() == ".blend":
        reason = damaged(path, str(error))
        return f"{reason}, or of a Blender that is much newer"
    return damaged(path, str(error))
