# SPDX-License-Identifier: GPL-3.0-or-later

"""The commands `resize`, `resample` and `sampling-table`."""

from dataclasses import replace
from typing import Any

from prefilter.commands import resample, resize, sampling_table
from prefilter.commands.host import Host
from prefilter.commands.program import COMMANDS
from prefilter.workflows import picture_files
from prefilter.workflows.space_names import AUTO

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


def _read(
    argument: str, path: str, *, is_data: bool, colorspace: str = AUTO, **more: Any
) -> Picture:
    """Reads a picture by Blender, or by the package if Blender would misinterpret it."""
    info = picture_files.probe(argument, path, is_data=is_data)
    if colorspace != AUTO or (info is not None and not info.is_plain):
        return picture_files.read(argument, path, is_data=is_data, colorspace=colorspace, **more)
    picture = read(images.load(argument, path, is_data=is_data))
    return replace(picture, is_gray=info is not None and info.is_gray)
