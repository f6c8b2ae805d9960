# SPDX-License-Identifier: GPL-3.0-or-later

"""What a user may set for a bake into the texture cache."""

from dataclasses import dataclass

from ..core.options import threads


@dataclass(frozen=True)
class CacheSettings:
    """How to bake."""

    threads: int = threads()
