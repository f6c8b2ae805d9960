# SPDX-License-Identifier: GPL-3.0-or-later

"""What the commands share: options, progress, messages."""

import argparse
import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from .._border import stopping
from .._work.outcome import Outcome
from .._work.progress import Work, go_on


def add_command(commands: Any, name: str, purpose: str, *notes: str) -> argparse.ArgumentParser:
    """Adds a command whose help ends in notes, which keep their lines."""
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=purpose,
        description=f"{purpose[0].upper()}{purpose[1:]}.",
        epilog="\n\n".join(notes),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    return parser


def check_ending(options: argparse.Namespace, name: str, path: str, allowed: Sequence[str]) -> str:
    """Returns the extension of a file; ends the program unless it is allowed."""
    # Of several that a name ends in, such as ".ply.gz" and ".gz", the longest one.
    fitting = [one for one in allowed if path.lower().endswith(one)]
    extension = max(fitting, key=len, default="")
    if not os.path.splitext(path)[1] or not extension:
        options.usage_error(f"{name}: found '{path}'; allowed: {', '.join(allowed)}")
    return extension


def done(work: Work) -> Outcome:
    """Computes and writes, with a line of progress."""
    with progress_line() as progress:
        try:
            work.compute(progress)
            go_on(progress, 1.0)
            return work.write()
        finally:
            work.discard()


def tell(outcome: Outcome) -> None:
    """Prints what was done, and on stderr what the user should look at."""
    warn(outcome.warnings)
    for note in outcome.notes:
        print(note)
    print(outcome.summary)


def warn(warnings: Iterable[str]) -> None:
    """Prints warnings on stderr."""
    for warning in warnings:
        print(f"prefilter: warning: {warning}", file=sys.stderr)


@contextmanager
def progress_line() -> Iterator["ProgressLine"]:
    """A line for as long as the context lasts, in which signals stop the work by it alone."""
    with stopping.held():
        line = ProgressLine()
        try:
            yield line
        finally:
            line.end()


class ProgressLine:
    """Shows progress on stderr: one line that changes on a terminal, else a line each quarter.

    Ctrl-C, or SIGTERM, has the work stop at its next report; a second one ends the program.
    """

    def __init__(self) -> None:
        """Shows nothing yet."""
        self._step = 1 if sys.stderr.isatty() else 25
        self._shown = -1

    def __call__(self, fraction: float) -> bool:
        """Shows how much is done, and says whether to go on."""
        percent = int(100 * fraction) // self._step * self._step
        if percent > self._shown:
            self._shown = percent
            line = f"prefilter: {percent:3d} %"
            print(line, end="\r" if self._step == 1 else "\n", file=sys.stderr, flush=True)
        return not stopping.asked()

    def end(self) -> None:
        """Leaves the line."""
        if self._step == 1 and self._shown >= 0:
            print(file=sys.stderr)
