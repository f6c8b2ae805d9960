# SPDX-License-Identifier: GPL-3.0-or-later

"""Work in parts, each of which is read in steps on the main thread, then computed in another."""

import time
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from .doing import Compute
from .jobs import Job

Steps = Generator[float, None, Compute]


@dataclass
class PartedWork:
    """Where the work is.

    Attributes:
        steps: What reads the part that is next; None once it is read.
        job: What computes the part that was read last; None while one is read.
        fraction_read: How much of the part is read.
        making: What then makes the results in steps; None before the last part is computed.
        seconds: How long the work has taken so far, in all threads that it has had.
    """

    steps: Steps | None = None
    job: Job[Any] | None = None
    fraction_read: float = 0.0
    making: Generator[None, None, None] | None = None
    seconds: float = 0.0

    @contextmanager
    def clock(self) -> Iterator[None]:
        """Counts the time that something takes."""
        began = time.monotonic()
        try:
            yield
        finally:
            self.seconds += time.monotonic() - began

    def read_on(self, seconds: float) -> None:
        """Reads for a time; starts the thread once everything is read."""
        assert self.steps is not None
        end = time.monotonic() + seconds
        with self.clock():
            try:
                while time.monotonic() < end:
                    self.fraction_read = next(self.steps)
            except StopIteration as done:
                self.steps = None
                self.job = Job(done.value)

    def make_on(self, seconds: float) -> bool:
        """Makes results for a time; returns whether all are made."""
        assert self.making is not None
        end = time.monotonic() + seconds
        with self.clock():
            for _ in self.making:
                if time.monotonic() >= end:
                    return False
        return True

    def result(self) -> Any:
        """Waits for the thread, and returns or raises what it did."""
        assert self.job is not None
        found = self.job.result()
        self.seconds += self.job.seconds
        return found

    def close(self) -> None:
        """Ends the reading, so that it takes back what it has changed."""
        if self.steps is not None:
            self.steps.close()
        if self.making is not None:
            self.making.close()
