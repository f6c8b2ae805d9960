# SPDX-License-Identifier: GPL-3.0-or-later

"""Standard output and standard error: they take any character, and closed ones lose what comes.

What a command does never fails because nobody reads what it says, or a console lacks a letter.
"""

import errno
import os
import sys
from contextlib import suppress
from typing import TextIO

_NOBODY_READS = {errno.EPIPE, errno.EBADF, *([errno.EINVAL] if os.name == "nt" else [])}
_NAMES = ("stdout", "stderr")
_failures: list[OSError] = []


def prepare() -> None:
    """Has both streams take any character: one that the encoding lacks becomes an escape.

    A stream that was closed before this program began is replaced by one that loses all it gets,
    down to its number, so that no file gets that number and what libraries print.
    """
    _failures.clear()
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name in _NAMES:
        stream = getattr(sys, name)
        if stream is None or stream.closed:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8", errors="replace"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def write(stream: TextIO, text: str, end: str = "\n") -> None:
    """Writes to a stream at once; what nobody reads any more is lost."""
    try:
        stream.write(text + end)
        stream.flush()
    except ValueError:
        pass  # It has been closed.
    except OSError as error:
        _silence(stream)
        if error.errno not in _NOBODY_READS:
            _failures.append(error)


def finish() -> None:
    """Writes what others have left in the streams.

    Raises:
        OSError: Something could not be written, although somebody may read it.
    """
    for name in _NAMES:
        write(getattr(sys, name), "", "")
    if _failures:
        raise _failures[0]


def _silence(stream: TextIO) -> None:
    """Loses what a stream still holds, and what comes: Python would fail at its end otherwise."""
    with suppress(OSError, ValueError):
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())
        os.close(nothing)
