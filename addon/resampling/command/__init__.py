# SPDX-License-Identifier: GPL-3.0-or-later

"""The commands."""

from typing import Any

from . import resample, resize, sampling_table


def add(commands: Any) -> None:
    """Adds the commands."""
    resize.add(commands)
    resample.add(commands)
    sampling_table.add(commands)
