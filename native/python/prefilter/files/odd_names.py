# SPDX-License-Identifier: GPL-3.0-or-later

"""Files whose names are no text, for libraries that take only text: they get another name."""

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
    """Tells whether a path can be written in UTF-8: names of files in Linux may be any bytes."""
    try:
        os.fspath(path).encode()
    except UnicodeEncodeError:
        return False
    return True


@contextmanager
def readable_name(path: str | os.PathLike[str]) -> Iterator[str]:
    """A path that is text, and leads to a file for as long as the context lasts.

    What is said of it in errors is said of the file.
    """
    given = os.fspath(path)
    if is_text(given):
        yield given
        return
    with temporary_folder() as folder:
        link = folder / f"file{_ending(given)}"
        link.symlink_to(os.path.abspath(given))
        try:
            yield str(link)
        except (OSError, ValueError) as error:
            if type(error) not in (OSError, ValueError):
                raise  # They say more than a text.
            raise type(error)(str(error).replace(str(link), given)) from error


def reads_any_name(
    function: Callable[Concatenate[Path, P], Result],
) -> Callable[Concatenate[Path, P], Result]:
    """Has a function that reads a file, its first argument, get a path that is text."""

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
    """The same for a function that writes a file; that is then moved to where it belongs."""

    @wraps(function)
    def write(path: Path, /, *arguments: P.args, **more: P.kwargs) -> None:
        if is_text(path):
            function(path, *arguments, **more)
            return
        with temporary_folder() as folder:
            made = folder / f"file{_ending(os.fspath(path))}"
            function(made, *arguments, **more)
            shutil.move(made, path)

    return write


def _ending(path: str) -> str:
    ending = Path(path).suffix
    return ending if is_text(ending) else ""
