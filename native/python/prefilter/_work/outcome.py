# SPDX-License-Identifier: GPL-3.0-or-later

"""What work ends with."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from .wording import listed

FAILURES = (ValueError, OSError, MemoryError)
"""What work raises for a reason that the user can act on."""


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
