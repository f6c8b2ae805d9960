# SPDX-License-Identifier: GPL-3.0-or-later

"""What the commands share: options, progress, messages."""

from prefilter._command.telling import ProgressLine, add_command, check_ending, done, tell, warn

__all__ = (
    "ProgressLine",
    "add_command",
    "check_ending",
    "done",
    "tell",
    "warn",
)
