# SPDX-License-Identifier: GPL-3.0-or-later

"""The commands."""

from typing import Any

from prefilter._command import resample, resize, sampling_table
from prefilter._command.host import Host
from prefilter._command.program import COMMANDS

from ...bridge import images
from ...bridge.images import Picture
from ...core import flags, presets
from ..new_picture import read
from ..properties import RESAMPLE, RESIZE


def add(commands: Any) -> None:
    """Adds the commands."""
    resize.add(commands, COMMANDS["resize"], presets.host(RESIZE, read=_read))
    resample.add(commands, COMMANDS["resample"], presets.host(RESAMPLE, read=_read))
    preferences = Host(settings=flags.settings_given, preferred=flags.PREFERRED)
    sampling_table.add(commands, COMMANDS["sampling-table"], preferences)


def _read(argument: str, path: str, *, is_data: bool) -> Picture:
    return read(images.load(argument, path, is_data=is_data))
