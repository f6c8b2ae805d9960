# SPDX-License-Identifier: GPL-3.0-or-later

"""Aliases for files whose names are no valid text, for libraries that need text."""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from .claims import temporary_folder

P = ParamSpec("P")
Result = TypeVar("Result")


def is_text(path: str | os.PathLike[str]) -> bool:
    """Tells whether a path is valid UTF-8; Linux allows file names of any bytes."""
    try:
        os.fspath(path).encode()
    except UnicodeEncodeError:
        return False
    return True


@contextmanager
def readable_name(path: str | os.PathLike[str]) -> Iterator[str]:
    """A context that yields a path of valid text to the file, through a link where needed.

    Error messages show the file's own path.
    """
    name = os.fspath(path)
    if is_text(name):
        yield name
        return
    with temporary_folder() as folder:
        link = folder / f"file{_ending(name)}"
        link.symlink_to(os.path.abspath(name))
        try:
            yield str(link)
        except (OSError, ValueError) as error:
            if type(error) not in (OSError, ValueError):
                raise  # Subclasses hold more than a message.
            raise type(error)(str(error).replace(str(link), name)) from error


def reads_any_name(
    function: Callable[Concatenate[Path, P], Result],
) -> Callable[Concatenate[Path, P], Result]:
    """Decorator: passes a path of valid text to a function that reads the file."""

    @wraps(function)
    def read(path: Path, /, *arguments: P.args, **more: P.kwargs) -> Result:
        if is_text(path):
            return function(path, *arguments, **more)
        with readable_name(path) as name:
            return function(Path(name), *arguments, **more)

    return read


def writes_any_name(
    function: Callable[Concatenate[Path, P], None],
) -> Callable[Concatenate[Path, P], None]:
    """Decorator: passes a path of valid text to a function that writes a file, then moves that."""

    @wraps(function)
    def write(path: Path, /, *arguments: P.args, **more: P.kwargs) -> None:
        if is_text(path):
            function(path, *arguments, **more)
            return
        with temporary_folder() as folder:
            temporary = folder / f"file{_ending(os.fspath(path))}"
            function(temporary, *arguments, **more)
            shutil.move(temporary, path)

    return write


def _ending(path: str) -> str:
    ending = Path(path).suffix
    return ending if is_text(ending) else ""
