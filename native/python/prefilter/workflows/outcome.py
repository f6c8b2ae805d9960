# SPDX-License-Identifier: GPL-3.0-or-later

"""What work ends with."""

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from .wording import listed

FAILURES = (ValueError, OSError, MemoryError)
"""What work raises for a reason that the user can act on."""


def reason(error: BaseException) -> str:
    """Returns what an error says: one of the system without its number."""
    if isinstance(error, MemoryError):
        return f"there is not enough memory{f': {error}' if str(error) else ''}"
    if not isinstance(error, OSError) or error.strerror is None:
        return str(error) or type(error).__name__
    names = [os.fsdecode(name) for name in (error.filename, error.filename2) if name is not None]
    return f"{error.strerror}: {' -> '.join(map(repr, names))}" if names else error.strerror


@dataclass(frozen=True)
class Outcome:
    """What was written, and what the user should know about it.

    Attributes:
        summary: One line.
        images: The names of the images that were made.
        objects: The names of the objects that show the results.
        files: The files that were written.
        warnings: What was left out or went less than well, and why.
        notes: More that is good to know.
    """

    summary: str
    images: list[str] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def up_to_date(targets: Iterable[Path]) -> str:
    """Returns what is told of files that need not be made again."""
    return f"Up to date: {listed(map(str, targets))}"
