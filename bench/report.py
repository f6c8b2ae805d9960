# SPDX-License-Identifier: GPL-3.0-or-later

"""Tables and verdicts of a benchmark, printed and kept as markdown."""

import sys
from collections.abc import Sequence
from pathlib import Path


class Report:
    """Prints tables, and keeps them as markdown; counts what does not hold."""

    def __init__(self) -> None:
        """Starts empty."""
        self.markdown: list[str] = []
        self.failures: list[str] = []

    def table(self, title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """Adds a table; all columns but the first are aligned at the right."""
        widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
        print(f"\n{title}")
        for row in (head, *rows):
            print("  " + "  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True)))
        sys.stdout.flush()
        ruler = ["---:"] * len(head)
        lines = (f"| {' | '.join(row)} |" for row in (head, ruler, *rows))
        self.markdown.append("\n".join([f"**{title}**", "", *lines, ""]))

    def verdict(self, holds: bool, claim: str) -> None:
        """Adds whether a criterion holds."""
        print(f"  {'holds' if holds else 'DOES NOT HOLD'}: {claim}", flush=True)
        self.markdown.append(f"{'Holds' if holds else '**Does not hold**'}: {claim}.\n")
        if not holds:
            self.failures.append(claim)

    def note(self, text: str) -> None:
        """Adds a sentence that is no criterion."""
        print(f"  {text}", flush=True)
        self.markdown.append(f"{text}.\n")

    def finish(self, markdown: Path | None) -> None:
        """Writes the tables to a file, and says which criteria do not hold.

        Raises:
            SystemExit: Some do not; the status is 1.
        """
        if markdown is not None:
            markdown.write_text("\n".join(self.markdown))
        count = len(self.failures)
        print(f"\n{count} of the criteria do not hold" if count else "\nall hold")
        for failure in self.failures:
            print(f"  {failure}")
        if count:
            raise SystemExit(1)
