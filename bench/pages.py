# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the tables and commands of the pages in docs/ from the results in bench/results/.

A page has marks; the text up to the end mark follows from the results that they name:

    <!-- result: NAME TABLE -->     a table of bench/results/NAME.json
    <!-- commands: NAME... -->      the commands that measure it, the date and the machine
    <!-- criteria: PAGE -->         the criteria of bench/results/verdicts.toml for a page
    <!-- verdicts -->               its verdicts, a table per subject

To keep the result of a program, give it `--json bench/results/NAME.json`, and run this.

usage: python3 bench/pages.py
"""

import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from bench import report  # noqa: E402

DOCS = ROOT / "docs"
RESULTS = ROOT / "bench" / "results"
MARK = re.compile(
    r"(<!-- (result|commands|criteria|verdicts)(?:: ([^>]*?))? -->\n)"
    r".*?(<!-- end of \2 -->)",
    re.DOTALL,
)


def pages() -> list[Path]:
    """Returns the pages that may have marks."""
    return sorted(DOCS.rglob("*.md"))


def rewritten(text: str) -> str:
    """Returns a page with current tables, commands and verdicts."""

    def made(found: re.Match[str]) -> str:
        kind, name = found[2], found[3] or ""
        lines = {
            "result": table,
            "commands": commands,
            "criteria": criteria,
            "verdicts": verdicts,
        }
        words = name.split() if kind == "commands" else name.split(maxsplit=1)
        return f"{found[1]}{lines[kind](*words)}\n{found[4]}"

    return MARK.sub(made, text)


def result(name: str) -> dict:
    """Returns a result."""
    return report.decoded((RESULTS / f"{name}.json").read_text(encoding="utf-8"))


def table(name: str, table_name: str) -> str:
    """Returns a table in Markdown; columns of numbers are aligned at the right."""
    found = result(name)["tables"][table_name]
    return _in_markdown(found["columns"], found["rows"])


def _in_markdown(columns: list[str], rows: list[list[str]]) -> str:
    rows = [[cell or "" for cell in row] for row in rows]
    ruler = [":---" if _is_text(column) else "---:" for column in zip(*rows, strict=True)]
    return "\n".join(f"| {' | '.join(row)} |" for row in (columns, ruler, *rows))


def commands(*names: str) -> str:
    """Returns the commands of results, with the machine and the date."""
    lines, notes = [], []
    for name in names:
        found = result(name)
        lines += [f"    {line}" for line in found["command"]]
        state = f", commit {found['commit']}" if found["commit"] else ""
        words = [f"Recorded {found['date']}{state}.", f"Machine: {found['machine']}."]
        words += [f"{note}." for note in found["notes"] if "earlier state" in note]
        notes.append(f"*{' '.join(words)}*")
    return "\n".join(["", *dict.fromkeys(lines), "", *dict.fromkeys(notes)])


def criteria(page: str) -> str:
    """Returns the criteria of a page's subject, and whether they hold."""
    lines = ["| Criterion | Found | |", "| :--- | :--- | :--- |"]
    for one in _verdicts()["criterion"]:
        if one["page"] == page:
            lines.append(f"| {one['text']} | {one['found']} | {one['verdict']} |")
    return "\n".join(lines)


def verdicts() -> str:
    """Returns the verdicts, a table per subject."""
    lines: list[str] = []
    subject = None
    for one in _verdicts()["verdict"]:
        if one["subject"] != subject:
            subject = one["subject"]
            lines += ["", f"## {subject}", "", "| | Verdict |", "| :--- | :--- |"]
        lines.append(f"| [{one['text'].rstrip('.')}]({one['link']}) | {one['found']} |")
    return "\n".join([*lines, ""])


def _verdicts() -> dict:
    return tomllib.loads((RESULTS / "verdicts.toml").read_text(encoding="utf-8"))


def _is_text(column: tuple[str, ...]) -> bool:
    return any(re.search(r"[^\W\d_]", cell) for cell in column)


if __name__ == "__main__":
    for path in pages():
        before = path.read_text(encoding="utf-8")
        after = rewritten(before)
        if after != before:
            path.write_text(after, encoding="utf-8")
            print(f"{path}: written")
