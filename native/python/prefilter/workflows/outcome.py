# SPDX-License-Identifier: GPL-3.0-or-later

"""Results of work, and reasons of failures."""

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from .wording import listed

FAILURES = (ValueError, OSError, MemoryError)
"""Exceptions that work raises for reasons that the user can act on."""


def reason(error: BaseException) -> str:
    """Returns the text of an error; system errors without their number."""
    if isinstance(error, MemoryError):
        return f"there is not enough memory{f': {error}' if str(error) else ''}"
    if not isinstance(error, OSError) or error.strerror is None:
        return str(error) or type(error).__name__
    names = [os.fsdecode(name) for name in (error.filename, error.filename2) if name is not None]
    return f"{error.strerror}: {' -> '.join(map(repr, names))}" if names else error.strerror


@dataclass(frozen=True)
class Outcome:
    """A summary of what work has produced, with warnings and notes for the user.

    Attributes:
        summary: One line.
        images: Names of the images that were made.
        objects: Names of the objects that show the results.
        files: Files that were written.
        warnings: Omissions and problems, with their reasons.
        notes: Further information.
    """

    summary: str
    images: list[str] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def up_to_date(targets: Iterable[Path]) -> str:
    """Returns the message about files that are up to date."""
    return f"Up to date: {listed(map(str, targets))}"
