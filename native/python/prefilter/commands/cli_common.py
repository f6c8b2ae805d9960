# SPDX-License-Identifier: GPL-3.0-or-later

"""Helpers that all commands share: common flags, progress, and messages."""

import argparse
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any

from .. import _native
from .._border import stopping
from ..options.flags import given
from ..workflows import progress as works
from ..workflows.outcome import Outcome, up_to_date
from ..workflows.progress import Progress, Work, go_on
from ..workflows.up_to_date import is_up_to_date
from .reporters import REPORTERS, PlainReporter

_NONE: Mapping[str, Any] = MappingProxyType({})
_reporter = PlainReporter()
_share: tuple[int, int] = (0, 1)
"""Which of how many equal shares of the command's progress the current work is."""


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


def add_progress(parser: argparse.ArgumentParser) -> None:
    """Adds the flag that chooses how progress is reported."""
    parser.add_argument(
        "--progress",
        choices=REPORTERS,
        default="plain",
        metavar="KIND",
        help="how progress and results are told: plain, for people; openjd, as Open Job "
        "Description reads them; json, an object a line on standard output (default: plain)",
    )


def add_skip_flag(parser: argparse.ArgumentParser) -> None:
    """Adds the flag that skips files that are up to date."""
    parser.add_argument(
        "--skip-up-to-date",
        action="store_true",
        help="skip outputs that were made from inputs with the same contents and the same "
        "settings; files then store a number that identifies both",
    )


def result_settings(
    options: argparse.Namespace, settings: type, *names: str, preset: Mapping[str, Any] = _NONE
) -> dict[str, Any]:
    """Returns the settings that determine a command's result, besides the input file itself.

    Args:
        options: The arguments.
        settings: The dataclass of the command's options.
        names: Names of arguments that are not options but matter too.
        preset: Options set by a preset.
    """
    chosen = {**preset, **given(options, settings)}
    chosen.pop("threads", None)
    more = {name: getattr(options, name, None) for name in names}
    return {"command": settings.__name__, "chosen": chosen, **more}


def check_stores_fingerprint(
    options: argparse.Namespace, path: str, allowed: Sequence[str]
) -> None:
    """Ends the program unless the file can store the fingerprint of its inputs."""
    if not path.lower().endswith(tuple(allowed)):
        options.usage_error(
            f"--skip-up-to-date: found '{path}', and only {', '.join(allowed)} files can tell"
        )


def are_up_to_date(targets: Sequence[Path], number: str) -> bool:
    """Tells whether all files store this fingerprint of their inputs; prints a line if so."""
    if not is_up_to_date(targets, number):
        return False
    print_line(up_to_date(targets))
    return True


def use_reporter(kind: str = "plain") -> None:
    """Selects how everything that follows is reported; see `add_progress`."""
    global _reporter, _share
    _reporter, _share = REPORTERS[kind](), (0, 1)


def check_extension(
    options: argparse.Namespace, name: str, path: str, allowed: Sequence[str]
) -> str:
    """Returns the extension of a file; ends the program unless it is allowed."""
    # Among several allowed extensions, such as ".ply.gz" and ".gz", the longest that matches.
    fitting = [candidate for candidate in allowed if path.lower().endswith(candidate)]
    extension = max(fitting, key=len, default="")
    if not os.path.splitext(path)[1] or not extension:
        options.usage_error(f"{name}: found '{path}'; allowed: {', '.join(allowed)}")
    return extension


def run_work(work: Work) -> Outcome:
    """Runs work to its end, reporting progress; returns its outcome."""
    with progress_line() as progress:
        try:
            work.compute(progress)
            go_on(progress, 1.0)
            return work.write()
        finally:
            work.discard()


@contextmanager
def subtask(number: int, count: int) -> Iterator[None]:
    """A context whose work is one of `count` equal shares of the command's progress."""
    global _share
    _share = (number, count)
    try:
        yield
    finally:
        _share = (0, 1)


def print_line(line: str) -> None:
    """Prints a line."""
    _reporter.print_line(line)


def report_outcome(outcome: Outcome) -> None:
    """Prints the result, and its warnings on stderr."""
    warn(outcome.warnings)
    _reporter.report(outcome)


def run_and_report(work: Work) -> None:
    """Runs work to its end, and prints the result."""
    report_outcome(run_work(work))


def warn(warnings: Iterable[str]) -> None:
    """Prints warnings on stderr."""
    for warning in warnings:
        _reporter.warn(warning)


def fail(text: str) -> None:
    """Prints why the command ends."""
    _reporter.fail(text)


def is_canceled(error: BaseException) -> bool:
    """Tells whether work failed because a signal asked it to stop."""
    # Interrupted work may fail with any exception, as Blender's operators do.
    return bool(stopping.asked()) or isinstance(error, _native.Cancelled | KeyboardInterrupt)


def cancel() -> None:
    """Prints that a signal has ended the command."""
    _reporter.cancel()


@contextmanager
def progress_line() -> Iterator[Progress]:
    """A context that yields a progress callback, through which alone signals stop the work.

    Ctrl-C or SIGTERM makes the work stop at its next report; a second one ends the program.
    """

    def report(fraction: float) -> bool:
        _reporter.show_progress(fraction)
        return not stopping.asked()

    number, count = _share
    with stopping.held():
        try:
            yield works.share(report, number / count, (number + 1) / count)
        except BaseException:
            _reporter.end_progress()
            raise
        if number + 1 == count:
            _reporter.end_progress()
