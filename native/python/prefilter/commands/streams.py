# SPDX-License-Identifier: GPL-3.0-or-later

"""Standard output and standard error, reserved for the messages of commands.

Commands never fail because a pipe is closed, or because a console cannot show a character.
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
    """The streams that commands write to, and the first failure to do so."""

    output: TextIO
    errors: TextIO
    failure: OSError | None = None


_streams: _Streams | None = None


def output() -> TextIO:
    """Returns the commands' standard output, even while other code's is redirected."""
    return sys.stdout if _streams is None else _streams.output


def errors() -> TextIO:
    """Returns the commands' standard error, even while other code's is redirected."""
    return sys.stderr if _streams is None else _streams.errors


def write(stream: TextIO, text: str, end: str = "\n") -> None:
    """Writes to a stream and flushes it; output to a closed pipe is dropped."""
    try:
        stream.write(text + end)
        stream.flush()
    except ValueError:
        pass  # The stream is closed.
    except OSError as error:
        _silence(stream)
        if error.errno not in _NOBODY_READS and _streams is not None:
            _streams.failure = error


def failure() -> OSError | None:
    """Returns why output could not be written, other than to a closed pipe; else None."""
    return None if _streams is None else _streams.failure


@contextmanager
def redirected(*, is_end: bool) -> Iterator[None]:
    """A context in which only messages of commands reach the standard streams.

    Everything that libraries, Blender and its importers print is dropped, or goes to standard
    error when debugging.

    Args:
        is_end: Whether to leave the redirection in place at the end. Blender prints something as it
            quits.
    """
    global _streams
    _prepare()
    before = sys.stdout, sys.stderr
    with _moved(is_end=is_end) as (own_output, own_errors):
        _streams = _Streams(own_output, own_errors)
        try:
            yield
        finally:
            _streams = None
            sys.stdout, sys.stderr = before


def _prepare() -> None:
    """Makes sure that descriptors 0 to 2 are open and that both stream objects exist.

    Otherwise a file opened later could get the descriptor of a closed stream, and with it the
    output of libraries.
    """
    if hasattr(signal, "SIGPIPE") and threading.current_thread() is threading.main_thread():
        # `write` handles closed pipes; in Blender SIGPIPE would end the process.
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
def _moved(*, is_end: bool) -> Iterator[tuple[TextIO, TextIO]]:
    """Redirects both streams; yields new streams that lead where they led before."""
    own = [_duplicate(getattr(sys, name), number) for name, number in _NUMBERS.items()]
    duplicates = {number: os.dup(number) for number in _NUMBERS.values()}
    for stream in (sys.stdout, sys.stderr):
        write(stream, "", "")
    sink = os.dup(2) if is_debugging() else os.open(os.devnull, os.O_WRONLY)
    for number in _NUMBERS.values():
        os.dup2(sink, number)
    _flush_c()  # Drop buffered output now, before it can appear after our last line.
    originals = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (_open_text(one) for one in (sink, os.dup(sink)))
    moved = sys.stdout, sys.stderr
    try:
        yield own[0], own[1]
    finally:
        for stream in moved:
            write(stream, "", "")
        _flush_c()
        for number, old in duplicates.items():
            if not is_end:
                os.dup2(old, number)
            os.close(old)
        # At the process's end, objects that others hold of the moved streams stay usable.
        finished = [] if is_end else list(moved)
        for stream in (*finished, *(each for each in own if each not in originals)):
            write(stream, "", "")
            stream.close()


def _duplicate(stream: TextIO, number: int) -> TextIO:
    """Returns a new stream to the same descriptor, or the stream itself if it was replaced."""
    try:
        if not os.path.samestat(os.fstat(stream.fileno()), os.fstat(number)):
            return stream
    except (OSError, ValueError):
        return stream
    return _open_text(os.dup(number), stream.encoding)


def _open_text(number: int, encoding: str = "utf-8") -> TextIO:
    return os.fdopen(number, "w", 1, encoding=encoding, errors="backslashreplace")


def _flush_c() -> None:
    """Flushes the buffers of C's stdio."""
    if os.name == "posix":
        ctypes.CDLL(None).fflush(None)


def _silence(stream: TextIO) -> None:
    """Drops a stream's buffered and future output, on which Python would fail at exit."""
    with suppress(OSError, ValueError):
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())
        os.close(nothing)
