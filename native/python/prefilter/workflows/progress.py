# SPDX-License-Identifier: GPL-3.0-or-later

"""Work that tells how much of it is done, and that can be stopped."""

from collections.abc import Callable
from typing import Protocol

from .. import _native
from .outcome import Outcome

Progress = Callable[[float], bool]
"""Gets the fraction done, in [0, 1]; returns False once the work should stop."""


class Work(Protocol):
    """Work on what was read."""

    def compute(self, progress: Progress) -> None:
        """Computes everything, and writes nothing; may run in another thread."""

    def write(self) -> Outcome:
        """Writes the results."""

    def discard(self) -> None:
        """Removes what is left of results that were not written."""


def go_on(progress: Progress, fraction: float) -> None:
    """Tells how much is done; raises prefilter.Cancelled if that was to be the end."""
    if not progress(fraction):
        raise _native.Cancelled("cancelled")


def share(progress: Progress, start: float, end: float) -> Progress:
    """Returns what reports the progress of a part of the work, from one fraction to another."""
    return lambda fraction: progress(start + (end - start) * fraction)


def parts(progress: Progress, count: int) -> list[Progress]:
    """Returns what reports the progress of each of several equal parts of the work."""
    return [share(progress, i / count, (i + 1) / count) for i in range(count)]
