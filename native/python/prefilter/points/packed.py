# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of points that gzip has packed."""

import gzip
import zlib

from .. import _native
from .._border.arguments import ProgressCallback, as_progress
from .._border.input import open_file

PACKED = ".gz"
_AT_ONCE = 1 << 20


def unpacked(path: str, progress: ProgressCallback | None = None) -> _native.UnpackedFile:
    """Unpacks a file into a temporary one, which is gone when nothing reads it any more.

    Raises:
        ValueError: The file is damaged, or nothing that gzip has packed.
        OSError: A file cannot be read or written.
        Cancelled: `progress` returned False.
    """
    told = as_progress(progress)
    target = _native.UnpackedFile(path)
    with open_file(path) as packed:
        size = max(packed.seek(0, 2), 1)
        packed.seek(0)
        with gzip.GzipFile(fileobj=packed) as source:
            while True:
                try:
                    some = source.read(_AT_ONCE)
                except (EOFError, zlib.error, gzip.BadGzipFile) as error:
                    raise ValueError(f"'{path}' cannot be unpacked by gzip: {error}") from error
                if not some:
                    return target
                target.write(some)
                if told is not None and told(packed.tell() / size) is False:
                    raise _native.Cancelled
