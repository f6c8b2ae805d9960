# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the tables of options in docs/ anew, from where the options are declared.

A table stands between `<!-- options: NAME -->` and `<!-- end of options -->`. NAME is a dataclass
of settings in the add-on, such as `mipmaps.choices.Settings`, or `command` and the name of a
command in Blender, or `program` and that of one of the package.

usage: scripts/run blender --background --python-exit-code 1 --python scripts/option_tables.py
"""

import argparse
import importlib
import re
from pathlib import Path

PACKAGE = "bl_ext.user_default.prefilter"
DOCS = Path(__file__).resolve().parents[1] / "docs"
TABLE = re.compile(r"(<!-- options: (.+?) -->\n).*?(<!-- end of options -->)", re.DOTALL)


def rewritten(text: str) -> tuple[str, int]:
    """Returns a page with its tables as they ought to be, and how many there are."""
    return TABLE.subn(lambda found: f"{found[1]}{table(found[2])}\n{found[3]}", text)


def table(name: str) -> str:
    """Returns a table in Markdown."""
    kind, _, command = name.partition(" ")
    if kind == "command":
        addon = importlib.import_module(PACKAGE)
        return command_table(addon.Commands(addon.SUBJECTS).parser(), command)
    if kind == "program":
        return command_table(
            importlib.import_module("prefilter.commands.program").parser(), command
        )
    module, _, settings = name.rpartition(".")
    options = importlib.import_module(f"{PACKAGE}.core.options")
    return options.table(getattr(importlib.import_module(f"{PACKAGE}.{module}"), settings))


def command_table(parser: argparse.ArgumentParser, name: str) -> str:
    """Returns the arguments of a command as a table."""
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    rows = ["| Argument | Meaning |", "|---|---|"]
    for action in commands.choices[name]._actions:
        if action.dest != "help":
            # The flag for each direction of a switch, and the short one of a value.
            names = (
                sorted(action.option_strings, key=len) if action.metavar else action.option_strings
            )
            shown = "`, `".join(names) or action.metavar
            if names and action.metavar:
                shown += f" {action.metavar}"
            rows.append(f"| `{shown}` | {(action.help or '').replace('%%', '%')} |")
    return "\n".join(rows)


if __name__ == "__main__":
    for page in sorted(DOCS.glob("*.md")):
        before = page.read_text(encoding="utf-8")
        after, _ = rewritten(before)
        if after != before:
            page.write_text(after, encoding="utf-8")
            print(f"{page}: written")
