# SPDX-License-Identifier: GPL-3.0-or-later

"""The queue of jobs: running, waiting and ended."""

import time
from dataclasses import dataclass, field
from enum import Enum

import bpy

from .runs import Run, redraw_panels
from .switches import Switches
from .translations import marked

_LISTED_AFTER_SECONDS = 0.5
"""A single job is listed only after this time, so that the panel does not flash."""
_jobs: list["QueuedJob"] = []


class State(Enum):
    """The state of a job."""

    WAITING = marked("Waiting")
    RUNNING = marked("Running")
    DONE = marked("Done")
    FAILED = marked("Failed")
    CANCELLED = marked("Canceled")


@dataclass(eq=False)
class QueuedJob:
    """A job.

    Attributes:
        queue_name: Jobs with the same queue run one after another.
        title: The operation and its target.
        switches: Its Cancel and Pause buttons.
        state: Its state.
        message: Why it failed, or waits although nothing else runs.
        run: Its progress, while it runs.
        began: When it was added, by `time.monotonic`.
    """

    queue_name: str
    title: str
    switches: Switches
    state: State = State.WAITING
    message: str = ""
    run: Run | None = None
    began: float = field(default_factory=time.monotonic)

    @property
    def is_active(self) -> bool:
        """Whether it is waiting or running."""
        return self.state in {State.WAITING, State.RUNNING}

    def is_next(self, context: bpy.types.Context) -> bool:
        """Returns whether it may start: its queue is idle, and all jobs before it are paused."""
        if is_taken(self.queue_name) or self.switches.is_paused(context):
            return False
        for job in _jobs:
            if job is self:
                return True
            waits = job.queue_name == self.queue_name and job.state is State.WAITING
            if waits and not job.switches.is_paused(context):
                return False
        return False

    def hold(self, context: bpy.types.Context, reason: str) -> None:
        """Sets the reason why it waits although it is next."""
        if self.message != reason:
            self.message = reason
            redraw_panels(context)

    def begin(self, run: Run) -> None:
        """Sets the state to running."""
        self.state, self.run, self.message = State.RUNNING, run, ""

    def end(self, context: bpy.types.Context, state: State, message: str = "") -> None:
        """Sets the final state; a second call does nothing."""
        if not self.is_active:
            return
        self.state, self.message, self.run = state, message, None
        self.switches.release(context)
        # Blender reports the result of a single job, so the list would add nothing.
        if len(_jobs) == 1:
            _jobs.clear()
        redraw_panels(context)

    def leave(self, context: bpy.types.Context) -> None:
        """Removes the job, because its file or window is closed."""
        self.end(context, State.CANCELLED)
        if self in _jobs:
            _jobs.remove(self)


def add(context: bpy.types.Context, queue_name: str, title: str) -> QueuedJob:
    """Adds a job at the end.

    Raises:
        ValueError: Too many jobs exist.
    """
    switches = Switches(context)
    if not any(job.is_active for job in _jobs):
        _jobs.clear()
    _jobs.append(QueuedJob(queue_name, title, switches))
    return _jobs[-1]


def is_taken(queue_name: str) -> bool:
    """Returns whether a job of a queue is running."""
    return any(job.queue_name == queue_name and job.state is State.RUNNING for job in _jobs)


def is_busy(queue_name: str) -> bool:
    """Returns whether a new job of a queue would have to wait."""
    return any(job.queue_name == queue_name and job.is_active for job in _jobs)


def listed() -> list[QueuedJob]:
    """Returns the jobs for the panel, oldest first."""
    soon = time.monotonic() - _LISTED_AFTER_SECONDS
    is_alone = len(_jobs) == 1
    return [job for job in _jobs if not is_alone or job.began < soon]


def has_ended() -> bool:
    """Returns whether any job has ended."""
    return any(not job.is_active for job in _jobs)


def clear() -> None:
    """Removes the jobs that have ended."""
    _jobs[:] = [job for job in _jobs if job.is_active]
