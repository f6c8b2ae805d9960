# SPDX-License-Identifier: GPL-3.0-or-later

"""The commands `bake` and `plot`."""

from typing import Any

from . import bake, plot


def add(commands: Any) -> None:
    """Adds the commands."""
    bake.add(commands)
    plot.add(commands)
