# SPDX-License-Identifier: GPL-3.0-or-later

"""Helpers of commands, from the package: options, progress, messages."""

from prefilter.commands.cli_common import (
    add_command,
    add_skip_flag,
    are_up_to_date,
    check_extension,
    check_stores_fingerprint,
    print_line,
    progress_line,
    report_outcome,
    run_and_report,
    run_work,
    subtask,
    warn,
)

__all__ = (
    "add_command",
    "add_skip_flag",
    "are_up_to_date",
    "check_extension",
    "check_stores_fingerprint",
    "print_line",
    "progress_line",
    "report_outcome",
    "run_and_report",
    "run_work",
    "subtask",
    "warn",
)
