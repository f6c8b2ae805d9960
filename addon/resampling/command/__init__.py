"""The commands on pictures."""

from typing import Any

from . import resample, resize


def add(commands: Any) -> None:
    """Adds the commands."""
    resize.add(commands)
    resample.add(commands)
