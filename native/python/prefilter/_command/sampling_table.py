# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `sampling-table`."""

import argparse
import os
from functools import partial
from pathlib import Path
from typing import Any

from .._border.staging import check_target
from .._options.flags import add_flags, given, tables
from .._options.tables import TableSettings
from .._work.resampling.table_making import ENDINGS, TableMaking
from .._work.wording import either
from . import telling
from .host import PLAIN, Host

_NOTES = """\
.json files hold the table itself, for --table and for `prefilter resample --table`; the others hold
shader code with the table in it.

examples:
  prefilter sampling-table lanczos2.glsl
  prefilter sampling-table tent.json tent.hlsl --filter tent --texels 4 --certify
  prefilter sampling-table tent.osl --table tent.json"""


def add(commands: Any, purpose: str, host: Host = PLAIN) -> None:
    """Adds the command."""
    notes = (*tables(TableSettings), _NOTES)
    parser = telling.add_command(commands, "sampling-table", purpose, *notes)
    parser.add_argument(
        "targets", metavar="OUTPUT", nargs="+", help=f"a file to write: {either(ENDINGS)}"
    )
    add_flags(parser, TableSettings, preferred=host.preferred)
    parser.set_defaults(execute=partial(_make, host), usage_error=parser.error)


def _make(host: Host, options: argparse.Namespace) -> None:
    for target in options.targets:
        telling.check_ending(options, "OUTPUT", target, ENDINGS)
    found = given(options, TableSettings)
    others = sorted(found.keys() - {"table", "threads"})
    if "table" in found and others:
        flag = f"--{others[0].removeprefix('use_')}"
        options.usage_error(f"--table: not allowed with {flag}, as no table is built")
    targets = [Path(os.path.realpath(target)) for target in options.targets]
    for path in targets:
        check_target(path)
    settings = host.settings(options, TableSettings)
    telling.tell(telling.done(TableMaking(settings, targets)))
