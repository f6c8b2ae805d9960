# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `sampling-table`."""

import argparse
import os
from functools import partial
from pathlib import Path
from typing import Any

from ..files.staging import check_target
from ..options.flags import add_flags, given, tables
from ..options.sampling import TableSettings
from ..workflows.images.table_making import ENDINGS, TableMaking
from ..workflows.wording import either
from . import cli_common, outputs
from .host import PLAIN, Host

_NOTES = """\
.json files hold the table itself, for --table and for `prefilter resample --table`; the others hold
shader code with the table in it.

examples:
  prefilter sampling-table -o lanczos2.glsl
  prefilter sampling-table -o tent.json -o tent.hlsl --filter tent --texels 4 --certify
  prefilter sampling-table -o tent.osl --table tent.json"""


def add(commands: Any, purpose: str, host: Host = PLAIN) -> None:
    """Adds the command."""
    notes = (*tables(TableSettings), _NOTES)
    parser = cli_common.add_command(commands, "sampling-table", purpose, *notes)
    kinds = either(ENDINGS)
    parser.add_argument(
        "targets", metavar="OUTPUT", nargs="*", help="the same as -o, for new files"
    )
    parser.add_argument(
        "-o",
        "--output",
        dest="outputs",
        metavar="OUTPUT",
        action="append",
        default=[],
        help=f"a file to write: {kinds}; repeat for several",
    )
    outputs.add_overwrite(parser)
    add_flags(parser, TableSettings, preferred=host.preferred)
    parser.set_defaults(execute=partial(_make, host), usage_error=parser.error)


def _paths(options: argparse.Namespace) -> list[str]:
    """Returns the files to write; ends the program without any."""
    for name in ("outputs", "targets"):
        paths = [outputs.checked_path(options, "OUTPUT", path) for path in getattr(options, name)]
        setattr(options, name, paths)
    if not options.outputs and not options.targets:
        options.usage_error("nothing to write: give -o OUTPUT")
    return [*options.outputs, *options.targets]


def _make(host: Host, options: argparse.Namespace) -> None:
    paths = _paths(options)
    for target in paths:
        cli_common.check_extension(options, "OUTPUT", target, ENDINGS)
    values = given(options, TableSettings)
    others = sorted(values.keys() - {"table", "threads"})
    if "table" in values and others:
        flag = f"--{others[0].removeprefix('use_')}"
        options.usage_error(f"--table: not allowed with {flag}, as no table is built")
    settings = host.settings(options, TableSettings)
    read = [settings.table] if settings.table else []
    options.is_positional = False
    outputs.check_not_replaced(options, options.outputs, read)
    options.is_positional = True
    outputs.check_not_replaced(options, options.targets, read)
    targets = [Path(os.path.realpath(target)) for target in paths]
    for path in targets:
        check_target(path)
    cli_common.run_and_report(TableMaking(settings, targets))
