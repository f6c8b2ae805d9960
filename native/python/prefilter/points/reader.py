# SPDX-License-Identifier: GPL-3.0-or-later

"""Protocol of Python readers that feed points to the native module, and their error handling."""

import contextlib
import importlib
from collections.abc import Iterator
from types import ModuleType
from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from .._border.input import open_file

POINTS_AT_ONCE = 1 << 16

# Positions (n, 3), normals (n, 3), weights (n,), viewpoints (n, 3), attributes (n, attributes).
PointChunk: TypeAlias = tuple[
    npt.NDArray[np.float64],
    npt.NDArray[np.float32] | None,
    npt.NDArray[np.float32] | None,
    npt.NDArray[np.float64] | None,
    npt.NDArray[np.float32],
]


class PointReader(Protocol):
    """Reads a file of points in chunks, any number of times."""

    @property
    def count(self) -> int | None:
        """Number of points; None where it is not known before reading."""

    @property
    def has_normals(self) -> bool: ...

    @property
    def attributes(self) -> list[tuple[str, bool]]:
        """Names of the attribute columns, and whether they hold bytes."""

    @property
    def viewpoint(self) -> tuple[float, float, float] | None:
        """Position of the scanner, in the coordinates of the points; None if it is not the
        same for all points, or not known."""

    @property
    def can_seek(self) -> bool:
        """Whether reading may begin at any point."""

    def chunks(self, begin: int = 0, end: int | None = None) -> Iterator[PointChunk]:
        """Yields all points in chunks or, for a reader that can seek, points [begin, end)."""


def find_module(name: str, path: str, files: str, package: str, other: str) -> ModuleType:
    """Imports the module that reads a file format.

    Args:
        name: Name of the module.
        path: Path of the file to read.
        files: Name of the format, for messages.
        package: Name of the package to install with pip.
        other: A format that needs no module, for messages.

    Raises:
        ValueError: The module cannot be imported.
    """
    # Report a file that cannot be opened before a missing module.
    with open_file(path):
        pass
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ValueError(
            f"'{path}': {files} need the Python module {name}, which is missing: {error}. Install "
            f"it by pip install {package}, or convert the file to {other}"
        ) from error


@contextlib.contextmanager
def damage_of(path: str, kind: str) -> Iterator[None]:
    """Turns any exception over a damaged file into a ValueError that names the file.

    A panic in a module written in Rust arrives as a direct subclass of BaseException.
    """
    try:
        yield
    except (MemoryError, KeyboardInterrupt, SystemExit, GeneratorExit):
        raise
    except BaseException as error:
        if isinstance(error, ValueError) and str(error).startswith(f"'{path}'"):
            raise
        raise ValueError(f"'{path}' cannot be read as {kind}: {_first_line(error)}") from error


def _first_line(error: BaseException) -> str:
    """First nonblank line of an error's message, or the name of its type."""
    lines = [line.strip() for line in str(error).splitlines()]
    return next((line for line in lines if line), type(error).__name__)
