# SPDX-License-Identifier: GPL-3.0-or-later

"""Work in parts: each is read in steps on the main thread, then computed in another thread."""

import time
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from .jobs import Job
from .operator_hooks import Compute

Steps = Generator[float, None, Compute]


@dataclass
class StagedWork:
    """The stage that the work has reached.

    Attributes:
        steps: Reads the next part; None once it is read.
        job: Computes the part that was read last; None while a part is being read.
        fraction_read: The fraction of the part that is read.
        build_steps: Builds the results in steps; None until the last part is computed.
        seconds: The time spent so far, on the main thread and in jobs.
    """

    steps: Steps | None = None
    job: Job[Any] | None = None
    fraction_read: float = 0.0
    build_steps: Generator[None, None, None] | None = None
    seconds: float = 0.0

    @contextmanager
    def clock(self) -> Iterator[None]:
        """Adds the duration of the context to `seconds`."""
        began = time.monotonic()
        try:
            yield
        finally:
            self.seconds += time.monotonic() - began

    def continue_reading(self, seconds: float) -> None:
        """Reads for some seconds; starts the thread once the part is read."""
        assert self.steps is not None
        end = time.monotonic() + seconds
        with self.clock():
            try:
                while time.monotonic() < end:
                    self.fraction_read = next(self.steps)
            except StopIteration as stop:
                self.steps = None
                self.job = Job(stop.value)

    def continue_building(self, seconds: float) -> bool:
        """Builds results for some seconds; returns whether all are built."""
        assert self.build_steps is not None
        end = time.monotonic() + seconds
        with self.clock():
            for _ in self.build_steps:
                if time.monotonic() >= end:
                    return False
        return True

    def result(self) -> Any:
        """Waits for the thread; returns its result or raises its exception."""
        assert self.job is not None
        result = self.job.result()
        self.seconds += self.job.seconds
        return result

    def close(self) -> None:
        """Closes the generators, which then undo their temporary changes."""
        if self.steps is not None:
            self.steps.close()
        if self.build_steps is not None:
            self.build_steps.close()
