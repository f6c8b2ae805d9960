#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the tables of public headers in docs/cpp.md from the first comment of each header.

A table stands between `<!-- headers: WING -->` and `<!-- end of headers -->`; WING is a folder of
native/include/prefilter.

usage: scripts/header_tables.py
"""

import re
from itertools import takewhile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1]
PUBLIC = SOURCE / "native" / "include" / "prefilter"
PAGE = SOURCE / "docs" / "cpp.md"
TABLE = re.compile(r"(<!-- headers: (\w+) -->\n).*?(<!-- end of headers -->)", re.DOTALL)


def summary(header: Path) -> str:
    """Returns the first comment of a header, up to its first empty line."""
    lines = header.read_text(encoding="utf-8").splitlines()[2:]
    comment = takewhile(lambda line: line.startswith("// "), lines)
    return " ".join(line.removeprefix("// ") for line in comment)


def rewritten(text: str) -> str:
    """Returns the page with current tables."""
    return TABLE.sub(lambda match: f"{match[1]}{_table(match[2])}\n{match[3]}", text)


def _table(wing: str) -> str:
    headers = sorted((PUBLIC / wing).glob("*.h"))
    rows = [f"| `{wing}/{path.name}` | {summary(path)} |" for path in headers]
    return "\n".join(["| Header | Contents |", "|---|---|", *rows])


if __name__ == "__main__":
    PAGE.write_text(rewritten(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
