# SPDX-License-Identifier: GPL-3.0-or-later

"""What the commands share: options, progress, messages."""

from prefilter.commands.telling import (
    add_command,
    add_skipping,
    are_up_to_date,
    check_can_tell,
    check_ending,
    done,
    progress_line,
    say,
    share,
    tell,
    warn,
)

__all__ = (
    "add_command",
    "add_skipping",
    "are_up_to_date",
    "check_can_tell",
    "check_ending",
    "done",
    "progress_line",
    "say",
    "share",
    "tell",
    "warn",
)
