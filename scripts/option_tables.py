# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the tables of options in docs/ from the declarations of the options.

A table stands between `<!-- options: NAME -->` and `<!-- end of options -->`. NAME is one of:

    mipmaps.choices.Settings     a dataclass of settings in the add-on
    command BLENDER [PACKAGE]    the commands of these names, in Blender and in the package, as one
                                 table; the package's has the same name if it is not given
    common                       the options that most commands share

usage: scripts/run blender --background --python-exit-code 1 --python scripts/option_tables.py
"""

import argparse
import functools
import importlib
import re
from pathlib import Path

PACKAGE = "bl_ext.user_default.prefilter"
DOCS = Path(__file__).resolve().parents[1] / "docs"
TABLE = re.compile(r"(<!-- options: (.+?) -->\n).*?(<!-- end of options -->)", re.DOTALL)
COMMON = (
    "--overwrite",
    "--preset",
    "--threads",
    "--list",
    "--json",
    "--skip-up-to-date",
    "--progress",
)


def rewritten(text: str) -> tuple[str, int]:
    """Returns a page with current tables, and their number."""
    return TABLE.subn(lambda found: f"{found[1]}{table(found[2])}\n{found[3]}", text)


def table(name: str) -> str:
    """Returns a table in Markdown."""
    kind, *commands = name.split()
    if kind == "common":
        return common_table()
    if kind == "command":
        return command_table(commands[0], commands[-1])
    module, _, settings = name.rpartition(".")
    options = importlib.import_module(f"{PACKAGE}.core.options")
    return options.table(getattr(importlib.import_module(f"{PACKAGE}.{module}"), settings))


def common_table() -> str:
    """Returns the options that most commands share, as a table."""
    return "\n".join(["| Argument | Meaning |", "|---|---|", *_common_rows().values()])


def command_table(in_blender: str, in_package: str) -> str:
    """Returns the arguments of a command as one table, in Blender and in the package.

    A third column names the program where an argument exists, or means this, in one of them only.
    The line below the table lists the options that are in the common table.
    """
    programs = {"Blender": _rows(_blender_parser(), in_blender)}
    package_rows = _rows(_package_parser(), in_package)
    if package_rows:
        programs["Package"] = package_rows
    lines, shared = {}, []
    for program, rows in programs.items():
        for argument, row in rows.items():
            if row == _common_rows().get(argument):
                shared.append(argument)
                continue
            is_everywhere = all(other.get(argument) == row for other in programs.values())
            place = "" if is_everywhere else program
            lines[argument, place] = f"{row} {place} |" if len(programs) > 1 else row
    order = list(dict.fromkeys(argument for rows in programs.values() for argument in rows))
    # Files come first, options after them.
    ordered = sorted(lines, key=lambda key: (key[0].startswith("`-"), order.index(key[0])))
    head = ["| Argument | Meaning |", "|---|---|"]
    if len(programs) > 1:
        head = ["| Argument | Meaning | Only in |", "|---|---|---|"]
    also = ", ".join(dict.fromkeys(shared))
    text = "\n".join([*head, *(lines[key] for key in ordered)])
    return f"{text}\n\nAnd the [common options](#common-options) {also}." if also else text


@functools.cache
def _common_rows() -> dict[str, str]:
    rows = {**_rows(_package_parser(), "voxelize"), **_rows(_blender_parser(), "voxelize")}
    return {name: row for name, row in rows.items() if name.strip("`").split()[0] in COMMON}


def _rows(parser: argparse.ArgumentParser, name: str) -> dict[str, str]:
    """Returns the rows of a command's arguments, by the argument; none if it does not exist."""
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    rows = {}
    for action in commands.choices[name]._actions if name in commands.choices else ():
        if action.dest != "help":
            # The flag for each direction of a switch, and the short one of a value.
            names = (
                sorted(action.option_strings, key=len) if action.metavar else action.option_strings
            )
            shown = "`, `".join(names) or action.metavar
            if names and action.metavar:
                words = action.metavar
                shown += f" {' '.join(words) if isinstance(words, tuple) else words}"
            # The page says once that preferences apply in Blender.
            meaning = (
                (action.help or "").replace("%%", "%").replace(", or as in the preferences", "")
            )
            rows[f"`{shown}`"] = f"| `{shown}` | {meaning} |"
    return rows


@functools.cache
def _blender_parser() -> argparse.ArgumentParser:
    addon = importlib.import_module(PACKAGE)
    return addon.Commands(addon.SUBJECTS).parser()


@functools.cache
def _package_parser() -> argparse.ArgumentParser:
    return importlib.import_module("prefilter.commands.program").make_parser()


if __name__ == "__main__":
    for page in sorted(DOCS.glob("*.md")):
        before = page.read_text(encoding="utf-8")
        after, _ = rewritten(before)
        if after != before:
            page.write_text(after, encoding="utf-8")
            print(f"{page}: written")
