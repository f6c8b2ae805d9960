# SPDX-License-Identifier: GPL-3.0-or-later

"""The commands."""

from typing import Any

from prefilter._command import resample, resize
from prefilter._command.program import COMMANDS

from ...bridge import images
from ...bridge.images import Picture
from ...core import presets
from ..new_picture import read
from ..properties import RESAMPLE, RESIZE
from . import sampling_table


def add(commands: Any) -> None:
    """Adds the commands."""
    resize.add(commands, COMMANDS["resize"], presets.host(RESIZE, read=_read))
    resample.add(commands, COMMANDS["resample"], presets.host(RESAMPLE, read=_read))
    sampling_table.add(commands)


def _read(argument: str, path: str, *, is_data: bool) -> Picture:
    return read(images.load(argument, path, is_data=is_data))
