# SPDX-License-Identifier: GPL-3.0-or-later

"""Files that are opened to be read."""

import errno
import os
from typing import BinaryIO


def open_file(path: str) -> BinaryIO:
    """Opens a file. Raises what `open` does, but for a folder IsADirectoryError on Windows too."""
    try:
        return open(path, "rb")
    except PermissionError:
        if not os.path.isdir(path):
            raise
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path) from None
