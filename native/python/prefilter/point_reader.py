"""What the native module needs of Python code that reads points."""

from collections.abc import Iterator
from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

# Of some points: positions (n, 3), normals (n, 3), weights (n,), viewpoints (n, 3), and attributes
# (n, attributes).
PointChunk: TypeAlias = tuple[
    npt.NDArray[np.float64],
    npt.NDArray[np.float32] | None,
    npt.NDArray[np.float32] | None,
    npt.NDArray[np.float64] | None,
    npt.NDArray[np.float32],
]


class PointReader(Protocol):
    """Reads a file of points from its first to its last, as often as is needed."""

    @property
    def count(self) -> int | None:
        """How many points there are, where that is known."""

    @property
    def has_normals(self) -> bool: ...

    @property
    def attributes(self) -> list[tuple[str, bool]]:
        """The names of the columns, and whether these hold bytes."""

    @property
    def viewpoint(self) -> tuple[float, float, float] | None:
        """Where the scanner stood, in the coordinates of the points; None where
        that differs among them, or is not known."""

    def chunks(self) -> Iterator[PointChunk]:
        """Yields points, some at a time, anew from the first."""
