# SPDX-License-Identifier: GPL-3.0-or-later

"""What the native module needs of Python code that reads points."""

import contextlib
import importlib
from collections.abc import Iterator
from types import ModuleType
from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from .._border.input import open_file

POINTS_AT_ONCE = 1 << 16

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

    @property
    def can_seek(self) -> bool:
        """Whether points can be read without those before them."""

    def chunks(self, begin: int = 0, end: int | None = None) -> Iterator[PointChunk]:
        """Yields points, some at a time: all anew, or where it can seek, from one to another."""


def find_module(name: str, path: str, files: str, package: str, other: str) -> ModuleType:
    """Imports the module that reads some files.

    Args:
        name: Of the module.
        path: Of the file to read.
        files: What files of its kind are called.
        package: What pip installs it by.
        other: A kind of files that needs no module.

    Raises:
        ValueError: It cannot be imported.
    """
    # What cannot be opened is no fault of the module.
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
    """Makes a ValueError that names the file of whatever a module makes of its damage.

    Modules written in Rust raise a BaseException of their own where they panic.
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
    """What an error says, without the dump that libE57 puts behind it."""
    lines = [line.strip() for line in str(error).splitlines()]
    return next((line for line in lines if line), type(error).__name__)
