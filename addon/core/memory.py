# SPDX-License-Identifier: GPL-3.0-or-later

"""Memory available for work."""

from prefilter import available_memory

from .preferences import preference

_MIB = 1 << 20


def usable_memory() -> tuple[float, str]:
    """Returns the number of bytes that work may use, and the reason for that limit as text."""
    free, limit = available_memory(), preference("memory_limit", 0) * _MIB
    if 0 < limit < free:
        return limit, f"the preferences allow {limit / _MIB:g} MiB"
    return free, f"{free / 1e9:.3g} GB are free"
