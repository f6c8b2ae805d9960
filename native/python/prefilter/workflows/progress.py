# SPDX-License-Identifier: GPL-3.0-or-later

"""Work that reports its progress and can be canceled."""

from collections.abc import Callable
from typing import Protocol

from .. import _native
from .outcome import Outcome

Progress = Callable[[float], bool]
"""Gets the fraction done, in [0, 1]; returns False once the work should stop."""


class Work(Protocol):
    """Work on inputs that have been read."""

    def compute(self, progress: Progress) -> None:
        """Computes the results and writes none; may run in another thread."""

    def write(self) -> Outcome:
        """Writes the results."""

    def discard(self) -> None:
        """Removes temporary files of results that were not written."""


def go_on(progress: Progress, fraction: float) -> None:
    """Reports progress; raises prefilter.Cancelled if the work should stop."""
    if not progress(fraction):
        raise _native.Cancelled("cancelled")


def share(progress: Progress, start: float, end: float) -> Progress:
    """Returns a callback for a part of the work, from fraction `start` to `end`."""
    return lambda fraction: progress(start + (end - start) * fraction)


def parts(progress: Progress, count: int) -> list[Progress]:
    """Returns callbacks for equal parts of the work."""
    return [share(progress, i / count, (i + 1) / count) for i in range(count)]
