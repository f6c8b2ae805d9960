# SPDX-License-Identifier: GPL-3.0-or-later

"""How much memory there is."""

import math

_MEMORY = "/proc/meminfo"


def available_memory() -> float:
    """Returns the bytes that can be had without driving others out; infinity where unknown."""
    try:
        with open(_MEMORY, encoding="ascii") as lines:
            for line in lines:
                if line.startswith("MemAvailable:"):
                    return 1024.0 * int(line.split()[1])
    except OSError:
        pass
    return math.inf
