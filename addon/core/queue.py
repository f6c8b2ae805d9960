# SPDX-License-Identifier: GPL-3.0-or-later

"""The queue: work that is under way, that waits for other work to end, and that has ended."""

import time
from dataclasses import dataclass, field
from enum import Enum

import bpy

from .running import Run, redraw_panels
from .switches import Switches
from .translations import marked

_LISTED_AFTER_SECONDS = 0.5
"""What is over at once is not worth a panel that comes and goes."""
_jobs: list["Queued"] = []


class State(Enum):
    """What becomes of a job."""

    WAITING = marked("Waiting")
    RUNNING = marked("Running")
    DONE = marked("Done")
    FAILED = marked("Failed")
    CANCELLED = marked("Canceled")


@dataclass(eq=False)
class Queued:
    """A job.

    Attributes:
        line: Jobs of the same line wait for each other.
        title: What it does, and with what.
        switches: Its buttons.
        state: What has become of it.
        message: Why it failed, or waits although nothing else runs.
        run: How far it is, while it runs.
        began: When it came, by the clock of `time.monotonic`.
    """

    line: str
    title: str
    switches: Switches
    state: State = State.WAITING
    message: str = ""
    run: Run | None = None
    began: float = field(default_factory=time.monotonic)

    @property
    def is_active(self) -> bool:
        """Whether it waits or runs."""
        return self.state in {State.WAITING, State.RUNNING}

    def is_next(self, context: bpy.types.Context) -> bool:
        """Tells whether it may begin: nothing of its line runs, and what is before it is paused."""
        if is_taken(self.line) or self.switches.is_paused(context):
            return False
        for job in _jobs:
            if job is self:
                return True
            waits = job.line == self.line and job.state is State.WAITING
            if waits and not job.switches.is_paused(context):
                return False
        return False

    def hold(self, context: bpy.types.Context, reason: str) -> None:
        """Notes why it waits although it is next."""
        if self.message != reason:
            self.message = reason
            redraw_panels(context)

    def begin(self, run: Run) -> None:
        """Notes that it runs."""
        self.state, self.run, self.message = State.RUNNING, run, ""

    def end(self, context: bpy.types.Context, state: State, message: str = "") -> None:
        """Notes what has become of it; another call does nothing."""
        if not self.is_active:
            return
        self.state, self.message, self.run = state, message, None
        self.switches.release(context)
        # Blender reports on it; a list of one thing that is over tells no more.
        if len(_jobs) == 1:
            _jobs.clear()
        redraw_panels(context)

    def leave(self, context: bpy.types.Context) -> None:
        """Leaves no trace, as the file or the window goes that it was for."""
        self.end(context, State.CANCELLED)
        if self in _jobs:
            _jobs.remove(self)


def add(context: bpy.types.Context, line: str, title: str) -> Queued:
    """Puts a job at the end.

    Raises:
        ValueError: There are too many.
    """
    switches = Switches(context)
    if not any(job.is_active for job in _jobs):
        _jobs.clear()
    _jobs.append(Queued(line, title, switches))
    return _jobs[-1]


def is_taken(line: str) -> bool:
    """Tells whether something of a line runs."""
    return any(job.line == line and job.state is State.RUNNING for job in _jobs)


def is_busy(line: str) -> bool:
    """Tells whether a job of a line would have to wait."""
    return any(job.line == line and job.is_active for job in _jobs)


def listed() -> list[Queued]:
    """Returns what the panel lists, in the order in which it came."""
    soon = time.monotonic() - _LISTED_AFTER_SECONDS
    is_alone = len(_jobs) == 1
    return [job for job in _jobs if not is_alone or job.began < soon]


def has_ended() -> bool:
    """Tells whether jobs are listed that have ended."""
    return any(not job.is_active for job in _jobs)


def clear() -> None:
    """Forgets the jobs that have ended."""
    _jobs[:] = [job for job in _jobs if job.is_active]
