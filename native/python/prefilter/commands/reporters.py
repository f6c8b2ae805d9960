# SPDX-License-Identifier: GPL-3.0-or-later

"""Reporters: how commands show progress and results to people, Open Job Description or programs.

All of them print warnings and errors as lines on standard error, which people read in logs.
"""

import json
from typing import Any

from ..workflows.outcome import Outcome
from . import streams


class PlainReporter:
    """For people: progress on standard error, results on standard output."""

    def __init__(self) -> None:
        """Starts without any progress shown."""
        self._shown = -1

    def show_progress(self, fraction: float) -> None:
        """Shows the percentage: one line that changes on a terminal, else a line each quarter."""
        step = 1 if streams.errors().isatty() else 25
        percent = self._next_percent(fraction, step)
        if percent is not None:
            line = f"prefilter: {percent:3d} %"
            streams.write(streams.errors(), line, end="\r" if step == 1 else "\n")

    def end_progress(self) -> None:
        """Ends the progress line."""
        if self._shown >= 0 and streams.errors().isatty():
            streams.write(streams.errors(), "")
        self._shown = -1

    def print_line(self, line: str) -> None:
        """Prints a line of requested output."""
        streams.write(streams.output(), line)

    def report(self, outcome: Outcome) -> None:
        """Prints the result."""
        for note in outcome.notes:
            self.print_line(note)
        self.print_line(outcome.summary)

    def warn(self, text: str) -> None:
        """Prints a warning."""
        streams.write(streams.errors(), f"prefilter: warning: {one_line(text)}")

    def fail(self, text: str) -> None:
        """Prints why the command ends."""
        streams.write(streams.errors(), f"prefilter: error: {one_line(text)}")

    def cancel(self) -> None:
        """Prints that a signal has ended the command."""
        streams.write(streams.errors(), "prefilter: canceled")

    def _next_percent(self, fraction: float, step: int = 1) -> int | None:
        """Returns the percentage if it has risen by a step since it was last shown, else None."""
        percent = int(100 * fraction) // step * step
        if percent <= self._shown:
            return None
        self._shown = percent
        return percent


class OpenJobReporter(PlainReporter):
    """For a session of Open Job Description, which parses lines with certain prefixes."""

    def show_progress(self, fraction: float) -> None:
        """Prints the percentage."""
        percent = self._next_percent(fraction)
        if percent is not None:
            streams.write(streams.output(), f"openjd_progress: {percent:.1f}")

    def end_progress(self) -> None:
        """Restarts at 0 %."""
        self._shown = -1

    def report(self, outcome: Outcome) -> None:
        """Prints the result, which becomes the status of the task."""
        for note in outcome.notes:
            self.print_line(note)
        self.print_line(f"openjd_status: {one_line(outcome.summary)}")

    def fail(self, text: str) -> None:
        """Prints why the command ends, which becomes the task's failure message."""
        super().fail(text)
        self.print_line(f"openjd_fail: {one_line(text)}")


class JsonReporter(PlainReporter):
    """For programs: one JSON object a line on standard output, keyed by its kind (and "files")."""

    def show_progress(self, fraction: float) -> None:
        """Prints the fraction, once per percent."""
        percent = self._next_percent(fraction)
        if percent is not None:
            self._print_object(progress=percent / 100)

    def end_progress(self) -> None:
        """Restarts at 0 %."""
        self._shown = -1

    def print_line(self, line: str) -> None:
        """Prints a line of requested output."""
        self._print_object(note=line)

    def report(self, outcome: Outcome) -> None:
        """Prints the result and the files that were written."""
        for note in outcome.notes:
            self.print_line(note)
        self._print_object(done=outcome.summary, files=outcome.files)

    def warn(self, text: str) -> None:
        """Prints a warning."""
        super().warn(text)
        self._print_object(warning=text)

    def fail(self, text: str) -> None:
        """Prints why the command ends."""
        super().fail(text)
        self._print_object(error=text)

    def cancel(self) -> None:
        """Prints that a signal has ended the command."""
        super().cancel()
        self._print_object(error="canceled")

    def _print_object(self, **values: Any) -> None:
        streams.write(streams.output(), json.dumps(values))  # ASCII, so any encoding can print it.


REPORTERS = {"plain": PlainReporter, "openjd": OpenJobReporter, "json": JsonReporter}
"""The reporters by their names in `--progress`."""


def one_line(text: str) -> str:
    """Returns a text in one line: names and messages of other libraries may have line breaks."""
    return " ".join(line.strip() for line in text.splitlines())
