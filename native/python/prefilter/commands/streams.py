# SPDX-License-Identifier: GPL-3.0-or-later

"""Standard output and standard error, which have only what commands say.

What a command does never fails because nobody reads what it says, or a console lacks a letter.
"""

import ctypes
import errno
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TextIO

from ..workflows.damage import is_debugging

_NOBODY_READS = {errno.EPIPE, errno.EBADF, *([errno.EINVAL] if os.name == "nt" else [])}
_NUMBERS = {"stdout": 1, "stderr": 2}


@dataclass
class _Streams:
    """Where commands write, and what went wrong."""

    output: TextIO
    errors: TextIO
    failure: OSError | None = None


_own: _Streams | None = None


def output() -> TextIO:
    """Returns standard output, whatever else it is that prints in this process."""
    return sys.stdout if _own is None else _own.output


def errors() -> TextIO:
    """Returns standard error likewise."""
    return sys.stderr if _own is None else _own.errors


def write(stream: TextIO, text: str, end: str = "\n") -> None:
    """Writes to a stream at once; what nobody reads any more is lost."""
    try:
        stream.write(text + end)
        stream.flush()
    except ValueError:
        pass  # It has been closed.
    except OSError as error:
        _silence(stream)
        if error.errno not in _NOBODY_READS and _own is not None:
            _own.failure = error


def failure() -> OSError | None:
    """Returns why something that may be read could not be written; None if all was."""
    return None if _own is None else _own.failure


@contextmanager
def apart(*, is_end: bool) -> Iterator[None]:
    """A context in which only what commands say reaches the streams.

    What libraries, Blender and its importers print is lost, or goes to standard error where
    somebody debugs.

    Args:
        is_end: Whether that stays so, because this process has no more to say. Blender prints
            something as it quits.
    """
    global _own
    _prepare()
    before = sys.stdout, sys.stderr
    with _quiet(is_end=is_end) as (own_output, own_errors):
        _own = _Streams(own_output, own_errors)
        try:
            yield
        finally:
            _own = None
            sys.stdout, sys.stderr = before


def _prepare() -> None:
    """Gives both streams numbers and objects, whatever was closed before this program began.

    A file that is opened later would get the number of a closed stream, and what libraries print.
    """
    if hasattr(signal, "SIGPIPE") and threading.current_thread() is threading.main_thread():
        # Python leaves pipes that nobody reads to `write`; Blender would end there.
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name in _NUMBERS:
        stream = getattr(sys, name)
        if stream is None or stream.closed:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8", errors="replace"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


@contextmanager
def _quiet(*, is_end: bool) -> Iterator[tuple[TextIO, TextIO]]:
    """Moves both streams elsewhere; yields those that go where they went."""
    own = [_same(getattr(sys, name), number) for name, number in _NUMBERS.items()]
    kept = {number: os.dup(number) for number in _NUMBERS.values()}
    for stream in (sys.stdout, sys.stderr):
        write(stream, "", "")
    sink = os.dup(2) if is_debugging() else os.open(os.devnull, os.O_WRONLY)
    for number in _NUMBERS.values():
        os.dup2(sink, number)
    _flush_c()  # It is nobody's any more; later it would come after our last line.
    given = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (_text(one) for one in (sink, os.dup(sink)))
    moved = sys.stdout, sys.stderr
    try:
        yield own[0], own[1]
    finally:
        for stream in moved:
            write(stream, "", "")
        _flush_c()
        for number, old in kept.items():
            if not is_end:
                os.dup2(old, number)
            os.close(old)
        # At the end, what others have kept of these goes on to work.
        done = [] if is_end else list(moved)
        for stream in (*done, *(each for each in own if each not in given)):
            write(stream, "", "")
            stream.close()


def _same(stream: TextIO, number: int) -> TextIO:
    """Returns a stream of its own to where a stream leads, or what somebody put in its place."""
    try:
        if not os.path.samestat(os.fstat(stream.fileno()), os.fstat(number)):
            return stream
    except (OSError, ValueError):
        return stream
    return _text(os.dup(number), stream.encoding)


def _text(number: int, encoding: str = "utf-8") -> TextIO:
    return os.fdopen(number, "w", 1, encoding=encoding, errors="backslashreplace")


def _flush_c() -> None:
    """Writes what C has not written yet."""
    if os.name == "posix":
        ctypes.CDLL(None).fflush(None)


def _silence(stream: TextIO) -> None:
    """Loses what a stream still holds, and what comes: Python would fail at its end otherwise."""
    with suppress(OSError, ValueError):
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())
        os.close(nothing)
