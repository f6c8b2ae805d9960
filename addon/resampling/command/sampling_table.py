# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `sampling-table`."""

import argparse
from typing import Any

from ...bridge.files import staging
from ...core import command
from ...core.flags import add_flags, given, settings_given, tables
from ...core.wording import either
from ..choices import TableSettings
from ..sampling_tables import ENDINGS, TableMaking

_HELP = "make a sampling table, as a file and as shader code"
_NOTES = """\
.json files hold the table itself, for --table and for `prefilter resample --table`; the others hold
shader code with the table in it.

examples:
  prefilter sampling-table lanczos2.glsl
  prefilter sampling-table tent.json tent.hlsl --filter tent --texels 4 --certify
  prefilter sampling-table tent.osl --table tent.json"""


def add(commands: Any) -> None:
    """Adds the command."""
    parser = command.add_command(commands, "sampling-table", _HELP, *tables(TableSettings), _NOTES)
    parser.add_argument(
        "targets", metavar="OUTPUT", nargs="+", help=f"a file to write: {either(ENDINGS)}"
    )
    add_flags(parser, TableSettings)
    parser.set_defaults(execute=_make, usage_error=parser.error)


def _make(options: argparse.Namespace) -> None:
    for target in options.targets:
        command.check_ending(options, "OUTPUT", target, ENDINGS)
    found = given(options, TableSettings)
    others = sorted(found.keys() - {"table", "threads"})
    if "table" in found and others:
        flag = f"--{others[0].removeprefix('use_')}"
        options.usage_error(f"--table: not allowed with {flag}, as no table is built")
    targets = [staging.check_output(target) for target in options.targets]
    command.tell(command.done(TableMaking(settings_given(options, TableSettings), targets)))
