# SPDX-License-Identifier: GPL-3.0-or-later

"""How commands say what they do: to people, to Open Job Description, or to other programs.

Warnings and errors are lines on standard error for all of them, which people read in logs.
"""

import json
from typing import Any

from ..workflows.outcome import Outcome
from . import streams


class Plain:
    """To people: progress on standard error, results on standard output."""

    def __init__(self) -> None:
        """Has shown no progress yet."""
        self._shown = -1

    def progress(self, fraction: float) -> None:
        """Shows how much is done: one line that changes on a terminal, else a line each quarter."""
        step = 1 if streams.errors().isatty() else 25
        percent = self._risen(fraction, step)
        if percent is not None:
            line = f"prefilter: {percent:3d} %"
            streams.write(streams.errors(), line, end="\r" if step == 1 else "\n")

    def end_progress(self) -> None:
        """Leaves the line of progress."""
        if self._shown >= 0 and streams.errors().isatty():
            streams.write(streams.errors(), "")
        self._shown = -1

    def say(self, line: str) -> None:
        """Prints a line of what was asked for."""
        streams.write(streams.output(), line)

    def tell(self, outcome: Outcome) -> None:
        """Prints what was done."""
        for note in outcome.notes:
            self.say(note)
        self.say(outcome.summary)

    def warn(self, text: str) -> None:
        """Prints what a user should look at."""
        streams.write(streams.errors(), f"prefilter: warning: {one_line(text)}")

    def fail(self, text: str) -> None:
        """Prints why the command ends."""
        streams.write(streams.errors(), f"prefilter: error: {one_line(text)}")

    def cancel(self) -> None:
        """Prints that a signal has ended the command."""
        streams.write(streams.errors(), "prefilter: canceled")

    def _risen(self, fraction: float, step: int = 1) -> int | None:
        """Returns percents where they have risen by a step; None where not."""
        percent = int(100 * fraction) // step * step
        if percent <= self._shown:
            return None
        self._shown = percent
        return percent


class OpenJobDescription(Plain):
    """To a session of Open Job Description, which reads lines with a certain beginning."""

    def progress(self, fraction: float) -> None:
        """Prints the percents."""
        percent = self._risen(fraction)
        if percent is not None:
            streams.write(streams.output(), f"openjd_progress: {percent:.1f}")

    def end_progress(self) -> None:
        """Starts anew."""
        self._shown = -1

    def tell(self, outcome: Outcome) -> None:
        """Prints what was done, which becomes the status of the task."""
        for note in outcome.notes:
            self.say(note)
        self.say(f"openjd_status: {one_line(outcome.summary)}")

    def fail(self, text: str) -> None:
        """Prints why the command ends, which becomes that of the task."""
        super().fail(text)
        self.say(f"openjd_fail: {one_line(text)}")


class JsonLines(Plain):
    """To programs: an object a line on standard output, whose only key but "files" is its kind."""

    def progress(self, fraction: float) -> None:
        """Prints the fraction, for each percent."""
        percent = self._risen(fraction)
        if percent is not None:
            self._print(progress=percent / 100)

    def end_progress(self) -> None:
        """Starts anew."""
        self._shown = -1

    def say(self, line: str) -> None:
        """Prints a line of what was asked for."""
        self._print(note=line)

    def tell(self, outcome: Outcome) -> None:
        """Prints what was done, and which files were written."""
        for note in outcome.notes:
            self.say(note)
        self._print(done=outcome.summary, files=outcome.files)

    def warn(self, text: str) -> None:
        """Prints what a user should look at."""
        super().warn(text)
        self._print(warning=text)

    def fail(self, text: str) -> None:
        """Prints why the command ends."""
        super().fail(text)
        self._print(error=text)

    def cancel(self) -> None:
        """Prints that a signal has ended the command."""
        super().cancel()
        self._print(error="canceled")

    def _print(self, **values: Any) -> None:
        streams.write(streams.output(), json.dumps(values))  # ASCII, which every encoding has.


VOICES = {"plain": Plain, "openjd": OpenJobDescription, "json": JsonLines}
"""By what `--progress` calls them."""


def one_line(text: str) -> str:
    """Returns a text without breaks of lines, which messages of others and names may have."""
    return " ".join(line.strip() for line in text.splitlines())
