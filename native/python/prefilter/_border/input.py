# SPDX-License-Identifier: GPL-3.0-or-later

"""Paths and input files."""

import errno
import os
from typing import BinaryIO


def as_path(path: str | os.PathLike[str]) -> str:
    try:
        name = os.fsdecode(path)
    except TypeError:
        name = "\0"
    if "\0" in name:
        raise ValueError(f"path: {path!r}; the path of a file is needed")
    return name


def open_file(path: str) -> BinaryIO:
    """Opens a file as `open` does, but raises IsADirectoryError for folders on Windows too."""
    try:
        return open(path, "rb")
    except PermissionError:
        if not os.path.isdir(path):
            raise
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path) from None
