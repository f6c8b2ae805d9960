# SPDX-License-Identifier: GPL-3.0-or-later

"""Threads for long work, with progress, pause, cancellation and result."""

import os
import threading
import time
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar, cast

import prefilter
from prefilter.workflows.progress import Progress, Work, go_on, parts, share

__all__ = ("Job", "Progress", "Work", "at_once", "go_on", "parts", "share")

T = TypeVar("T")


def at_once(works: Sequence[Callable[[Progress], None]], progress: Progress, threads: int) -> None:
    """Runs functions in parallel, each in one thread.

    Args:
        works: Each takes its own progress callback. They start in this order.
        progress: Called with the overall fraction done, from any thread, one call at a time.
        threads: The number of threads; 0 for the number of processors.

    Raises:
        BaseException: The exception of the first function that fails; the others are stopped.
    """
    from concurrent.futures import ThreadPoolExecutor, wait

    done = [0.0] * len(works)
    lock = threading.Lock()
    failed = threading.Event()

    def part(index: int) -> Progress:
        def report(fraction: float) -> bool:
            with lock:
                done[index] = fraction
                return not failed.is_set() and progress(sum(done) / len(works))

        return report

    def run(index: int) -> None:
        if failed.is_set():
            return
        try:
            works[index](part(index))
        except BaseException:
            failed.set()
            raise

    count = min(threads or os.cpu_count() or 1, len(works))
    if count <= 1:
        for index in range(len(works)):
            run(index)
        return
    with ThreadPoolExecutor(count, "prefilter work") as executor:
        futures = [executor.submit(run, index) for index in range(len(works))]
        try:
            wait(futures)
        except BaseException:  # An interrupt from the keyboard.
            failed.set()
            raise
    failures = [error for future in futures if (error := future.exception()) is not None]
    # The functions that were stopped raise Cancelled, which hides the cause.
    failures.sort(key=lambda error: isinstance(error, prefilter.Cancelled))
    if failures:
        raise failures[0]


class Job(Generic[T]):
    """Runs a callable in a thread.

    The callable gets a `Progress`. It must not touch Blender's data.
    """

    def __init__(self, work: Callable[[Progress], T]) -> None:
        """Starts the thread."""
        self._work = work
        self._progress = 0.0
        self._cancelled = threading.Event()
        self._may_go_on = threading.Event()
        self._may_go_on.set()
        self._is_held = False
        self._seconds_held = 0.0
        self._result: T | None = None
        self._error: BaseException | None = None
        self._seconds = 0.0
        self._lock = threading.Lock()
        self._has_ended = False
        self._release: Callable[[], None] | None = None
        self._thread = threading.Thread(target=self._run, name="prefilter job")
        self._thread.start()

    @property
    def progress(self) -> float:
        """The fraction done, in [0, 1]."""
        return self._progress

    @property
    def is_done(self) -> bool:
        """Whether the callable has returned or raised."""
        return not self._thread.is_alive()

    @property
    def seconds(self) -> float:
        """Running time without pauses, once the callable is done."""
        return self._seconds

    @property
    def is_held(self) -> bool:
        """Whether the callable waits, at a progress call, for the end of a pause."""
        return self._is_held

    def pause(self, *, is_paused: bool) -> None:
        """Makes the callable wait at its next progress call, or continue."""
        if is_paused:
            self._may_go_on.clear()
        else:
            self._may_go_on.set()

    def cancel(self) -> None:
        """Asks the callable to stop; it does so at its next progress call."""
        self._cancelled.set()
        self._may_go_on.set()

    def abandon(self, release: Callable[[], None]) -> None:
        """Asks the callable to stop, without waiting for it.

        Args:
            release: Called after it has stopped, from its thread or from this one.
        """
        self.cancel()
        with self._lock:
            if not self._has_ended:
                self._release = release
                return
        release()

    def result(self) -> T:
        """Waits for the callable; returns its result or raises its exception."""
        self._thread.join()
        if self._error is not None:
            raise self._error
        return cast(T, self._result)

    def _run(self) -> None:
        began = time.monotonic()
        try:
            self._result = self._work(self._advance)
        except BaseException as error:  # result() raises it.
            self._error = error
        self._seconds = time.monotonic() - began - self._seconds_held
        with self._lock:
            self._has_ended = True
        if self._release is not None:
            self._release()

    def _advance(self, fraction: float) -> bool:
        self._progress = fraction
        if not self._may_go_on.is_set() and not self._cancelled.is_set():
            began = time.monotonic()
            self._is_held = True
            self._may_go_on.wait()
            self._is_held = False
            self._seconds_held += time.monotonic() - began
        return not self._cancelled.is_set()
