# SPDX-License-Identifier: GPL-3.0-or-later

"""How much memory there is."""

from . import _native as native


def available_memory() -> float:
    """Returns the bytes that can be had without driving others out; infinity where unknown."""
    return native.available_memory()
