# SPDX-License-Identifier: GPL-3.0-or-later

"""How much memory there is."""

from collections.abc import Callable

from .._native import available_memory

Memory = Callable[[], tuple[float, str]]
"""Returns the bytes that work may use, and in words what sets that limit."""


def free_memory() -> tuple[float, str]:
    """Returns the bytes that are free, and says so in words."""
    free = available_memory()
    return free, f"{free / 1e9:.3g} GB are free"
