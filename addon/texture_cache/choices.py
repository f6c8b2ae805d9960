# SPDX-License-Identifier: GPL-3.0-or-later

"""Options of bakes into the texture cache."""

from dataclasses import dataclass

from ..core.options import threads


@dataclass(frozen=True)
class CacheSettings:
    """Options of the command."""

    threads: int = threads()
