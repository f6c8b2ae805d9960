# SPDX-License-Identifier: GPL-3.0-or-later

"""Free memory."""

from collections.abc import Callable

from .._native import available_memory

Memory = Callable[[], tuple[float, str]]
"""Returns the bytes that work may use, and a text that names the limit."""


def free_memory() -> tuple[float, str]:
    """Returns the number of free bytes, and a text that says so."""
    free = available_memory()
    return free, f"{free / 1e9:.3g} GB are free"
