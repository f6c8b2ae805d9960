# SPDX-License-Identifier: GPL-3.0-or-later

"""Objects that vanish in voxelization, because no cell is filled enough."""

from collections.abc import Sized

from ..wording import Sentence, joined, listed

NO_FILLED_CELL = Sentence(
    "the result is empty: no cell is at least half full. Parts that are thinner "
    "than a cell, or enclose nothing, disappear"
)


class NothingLeftError(ValueError):
    """A mesh has no area, or fills no cell enough for a surface."""


def check_area(area: float) -> None:
    """Raises NothingLeftError if a mesh has no area."""
    if area == 0.0:
        raise NothingLeftError(Sentence("all its faces have zero area"))


class EmptyResults:
    """Objects without a result, grouped by reason."""

    def __init__(self) -> None:
        """Starts with none."""
        self._names: dict[str, list[str]] = {}

    def add(self, name: str, error: NothingLeftError) -> None:
        """Adds an object, with the reason why it vanished."""
        self._names.setdefault(error.args[0], []).append(name)

    def warnings_for(self, results: Sized) -> list[Sentence]:
        """Returns warnings about the objects, if other objects have results.

        Raises:
            ValueError: There are no results.
        """
        lines = [
            Sentence("object {}: {}" if len(names) == 1 else "objects {}: {}", listed(names), why)
            for why, names in self._names.items()
        ]
        if not results:
            raise ValueError(joined("; ", lines))
        return [Sentence("left out: {}", line) for line in lines]
