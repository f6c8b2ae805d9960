# SPDX-License-Identifier: GPL-3.0-or-later

"""Registering what consists of parts."""

from collections.abc import Callable
from typing import Protocol


class Part(Protocol):
    """A module or a package that comes and goes with the add-on."""

    def register(self) -> None:
        """Makes it known to Blender."""

    def unregister(self) -> None:
        """Takes back what `register` did."""


def registration(*parts: Part) -> tuple[Callable[[], None], Callable[[], None]]:
    """Returns functions that register parts in their order, and unregister them in reverse."""

    def register() -> None:
        for part in parts:
            part.register()

    def unregister() -> None:
        for part in reversed(parts):
            part.unregister()

    return register, unregister
