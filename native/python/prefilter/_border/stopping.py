# SPDX-License-Identifier: GPL-3.0-or-later

"""Signals that ask a command to stop: Ctrl-C, and SIGTERM as farms and services send it.

A signal raises KeyboardInterrupt in the main thread, so that unfinished files are removed. Code
that holds signals back polls `asked`, or is interrupted once it releases them.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class _Stopping:
    def __init__(self) -> None:
        self.number = 0
        self._holds = 0

    @contextmanager
    def handled(self) -> Iterator[None]:
        self.number = self._holds = 0
        before = [signal.signal(signum, self._note) for signum in _SIGNALS]
        try:
            yield
        finally:
            for signum, handler in zip(_SIGNALS, before, strict=True):
                # None means Blender's own handler, not Python's; it only waits for another Ctrl-C.
                signal.signal(signum, signal.SIG_DFL if handler is None else handler)
            self.number = 0  # Later work in the same process goes on.

    @contextmanager
    def held(self) -> Iterator[None]:
        if threading.current_thread() is not threading.main_thread():
            yield  # Signals interrupt the main thread only.
            return
        self._holds += 1
        came_before = self.number
        try:
            yield
        finally:
            self._holds -= 1
        if self.number != came_before and not self._holds:
            raise KeyboardInterrupt

    def _note(self, number: int, *_: object) -> None:
        self.number = number
        for signum in _SIGNALS:  # A second signal ends the program.
            signal.signal(signum, signal.SIG_DFL)
        if not self._holds:
            raise KeyboardInterrupt


_stopping = _Stopping()
handled, held = _stopping.handled, _stopping.held
"""Contexts: a command that signals stop, on the main thread; and code they must not interrupt."""


def asked() -> int:
    """Returns the signal that has asked the command to stop; 0 if none has."""
    return _stopping.number


def status() -> int:
    """Returns the exit status of a stopped command: 130 after Ctrl-C, 143 after SIGTERM."""
    return 128 + (_stopping.number or signal.SIGINT)
