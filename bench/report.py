# SPDX-License-Identifier: GPL-3.0-or-later

"""Tables and verdicts of a benchmark: printed, and written as a result for bench/results/."""

import argparse
import datetime
import json
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# A number in JSON. Cells keep their digits: 0.970 stays 0.970.
_NUMBER = re.compile(r"-?(0|[1-9]\d*)(\.\d+)?")


class Report:
    """Prints tables and keeps them; counts the criteria that do not hold."""

    def __init__(self) -> None:
        """Starts empty."""
        self.tables: dict[str, dict[str, object]] = {}
        self.notes: list[str] = []
        self.failures: list[str] = []

    def table(
        self, title: str, head: Sequence[str], rows: Sequence[Sequence[str]], name: str = ""
    ) -> None:
        """Adds a table; all columns but the first are aligned at the right.

        Args:
            title: Is printed above it.
            head: The names of columns.
            rows: The cells.
            name: What pages ask for it by; the title's words if it is empty.
        """
        name = name or "-".join(re.findall(r"[\w.]+", title.lower()))
        widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
        print(f"\n{title}")
        for row in (head, *rows):
            print("  " + "  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True)))
        sys.stdout.flush()
        if name in self.tables:
            raise ValueError(f"there are two tables {name!r}")
        self.tables[name] = {"title": title, "columns": list(head), "rows": [*map(list, rows)]}

    def verdict(self, holds: bool, claim: str) -> None:
        """Adds whether a criterion holds."""
        line = f"{'holds' if holds else 'DOES NOT HOLD'}: {claim}"
        print(f"  {line}", flush=True)
        self.notes.append(line)
        if not holds:
            self.failures.append(claim)

    def note(self, text: str) -> None:
        """Adds a sentence that is no criterion."""
        print(f"  {text}", flush=True)
        self.notes.append(text)

    def write(self, path: Path | None) -> None:
        """Writes the result to a file, unless it is None."""
        if path is not None:
            result = {
                "command": [command()],
                "machine": machine(),
                "date": datetime.date.today().isoformat(),
                "commit": commit(),
                "notes": self.notes,
                "tables": self.tables,
            }
            path.write_text(encoded(result), encoding="utf-8")

    def finish(self, path: Path | None) -> None:
        """Writes the result, and says which criteria do not hold.

        Raises:
            SystemExit: Some do not; the status is 1.
        """
        self.write(path)
        count = len(self.failures)
        print(f"\n{count} of the criteria do not hold" if count else "\nall hold")
        for failure in self.failures:
            print(f"  {failure}")
        if count:
            raise SystemExit(1)


def add_json_option(parser: argparse.ArgumentParser) -> None:
    """Adds --json, the file that a result is written to."""
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the result to this file")


def encoded(result: dict[str, object]) -> str:
    """Returns a result as JSON: a line for each row of a table."""
    lines = [f" {json.dumps(key)}: {_encoded(key, value)}" for key, value in result.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def decoded(text: str) -> dict:
    """Returns a result; cells are texts, and numbers keep the digits of the file."""
    return json.loads(text, parse_float=str, parse_int=str)


def command() -> str:
    """Returns the command that started this program, as it is typed in a checkout."""
    started = sys.orig_argv
    program = Path(sys.argv[0] if "-m" not in started[:3] else started[2])
    if "--python" in started:  # Blender
        program = Path(started[started.index("--python") + 1])
        before = "scripts/run blender --background --python-exit-code 1 --python"
        if "--enable-event-simulate" in started:
            before = "scripts/run xvfb-run -a blender --enable-event-simulate --python"
        arguments = started[started.index("--") :] if "--" in started else []
    elif "-m" in started[:3]:
        before, arguments = "scripts/run python3 -m", started[3:]
    else:
        before, arguments = "scripts/run python3", sys.argv[1:]
    if program.is_absolute() and program.is_relative_to(ROOT):
        program = program.relative_to(ROOT)
    if "--json" in arguments:
        at = arguments.index("--json")
        arguments = arguments[:at] + arguments[at + 2 :]
    if arguments == ["--"]:
        arguments = []
    return f"{before} {shlex.join([str(program), *arguments])}"


def machine() -> str:
    """Returns the machine and software that the figures were measured on."""
    names = re.findall(r"^model name\s*: (.*)$", _read("/proc/cpuinfo"), re.M)
    systems = re.findall(r'^PRETTY_NAME="(.*)"$', _read("/etc/os-release"), re.M)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    parts = [
        f"{os.cpu_count()} x {names[0] if names else platform.machine()}",
        f"{memory / 2**30:.0f} GiB",
        systems[0] if systems else platform.platform(),
        f"Python {platform.python_version()}",
    ]
    if (blender := sys.modules.get("bpy")) is not None:
        parts.append(f"Blender {blender.app.version_string}")
    return "; ".join(parts)


def commit() -> str | None:
    """Returns the commit of the checkout, with a plus sign if files differ from it.

    None where there is no Git: programs run where Blender's libraries are.
    """
    if shutil.which("git") is None:
        return None
    found = subprocess.run(
        ["git", "-C", ROOT, "describe", "--always", "--dirty=+", "--exclude", "*"],
        capture_output=True,
        text=True,
        check=False,
    )
    return found.stdout.strip() or None


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError:
        return ""


def _encoded(key: str, value: object) -> str:
    if key != "tables":
        return json.dumps(value, ensure_ascii=False)
    assert isinstance(value, dict)
    tables = []
    for name, table in value.items():
        rows = ",\n".join(f"    [{', '.join(map(_cell, row))}]" for row in table["rows"])
        tables.append(
            f"  {json.dumps(name)}: {{\n"
            f'   "title": {json.dumps(table["title"], ensure_ascii=False)},\n'
            f'   "columns": {json.dumps(table["columns"], ensure_ascii=False)},\n'
            f'   "rows": [\n{rows}\n   ]\n  }}'
        )
    return "{\n" + ",\n".join(tables) + "\n }"


def _cell(text: str) -> str:
    if not text:
        return "null"
    return text if _NUMBER.fullmatch(text) else json.dumps(text, ensure_ascii=False)
