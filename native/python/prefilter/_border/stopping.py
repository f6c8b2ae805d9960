# SPDX-License-Identifier: GPL-3.0-or-later

"""Signals that ask a command to stop: Ctrl-C, and SIGTERM as farms and services send it.

They interrupt it where it stands, as KeyboardInterrupt, so that whatever has files in the making
removes them. Where they are held, whoever holds them looks for one, or they interrupt it after.
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
    def heeded(self) -> Iterator[None]:
        self.number = self._holds = 0
        before = [signal.signal(one, self._note) for one in _SIGNALS]
        try:
            yield
        finally:
            for one, handler in zip(_SIGNALS, before, strict=True):
                # Blender's own handler is none of Python's; it only waits for another Ctrl-C.
                signal.signal(one, signal.SIG_DFL if handler is None else handler)

    @contextmanager
    def held(self) -> Iterator[None]:
        if threading.current_thread() is not threading.main_thread():
            yield  # Signals never interrupt it.
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
        for one in _SIGNALS:  # A second one ends the program.
            signal.signal(one, signal.SIG_DFL)
        if not self._holds:
            raise KeyboardInterrupt


_stopping = _Stopping()
heeded, held = _stopping.heeded, _stopping.held
"""Contexts: a command, on the main thread; and what no signal may interrupt."""


def asked() -> int:
    """The signal that has asked the command to stop; 0 where none has."""
    return _stopping.number


def status() -> int:
    """The exit status of a command that was stopped: 130 after Ctrl-C, 143 after SIGTERM."""
    return 128 + (_stopping.number or signal.SIGINT)
