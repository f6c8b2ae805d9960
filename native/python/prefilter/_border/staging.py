# SPDX-License-Identifier: GPL-3.0-or-later

"""Files staged beside their target and renamed into place, so that no half-written one is seen.

The package and the add-on write all files by this, but for those that the library streams.
"""

import os
import shutil
import stat
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, cast

from .input import as_path
from .replacing import Kept, beside, journal, put_back, recover, rename, second_name

Output = str | os.PathLike[str] | BinaryIO

_WRITE_BITS = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH
_KINDS = {stat.S_IFDIR: "folder", stat.S_IFIFO: "pipe", stat.S_IFSOCK: "socket"}


@dataclass(frozen=True)
class StagedFile:
    """A finished file under a temporary name, in the folder of its target."""

    temporary: Path
    target: Path

    def commit(self) -> None:
        """Renames the file into place; it gets the mode of a file that it replaces."""
        check_regular(self.target)
        if self.target.exists():
            shutil.copymode(self.target, self.temporary)
        rename(self.temporary, self.target)

    def discard(self) -> None:
        """Removes the temporary file, if it is still there."""
        self.temporary.unlink(missing_ok=True)


@dataclass(frozen=True)
class StagedFolder:
    """A finished file with those that go with it, in a temporary folder beside its target."""

    temporary: Path
    target: Path

    def commit(self) -> None:
        """Moves the files into place, the target last, and removes the folder."""
        written = sorted(self.temporary.iterdir(), key=lambda path: path.name == self.target.name)
        commit_all([StagedFile(path, self.target.with_name(path.name)) for path in written])
        self.discard()

    def discard(self) -> None:
        """Removes the temporary folder."""
        shutil.rmtree(self.temporary, ignore_errors=True)


def stage_with(target: Path, write: Callable[[Path], object]) -> StagedFile:
    """Has a function write a file beside its target, by its path.

    Raises:
        OSError: The file cannot be written.
    """
    recover(target.parent)
    staged = StagedFile(beside(target), target)
    try:
        write(staged.temporary)
    except BaseException:
        staged.discard()
        raise
    return staged


def stage_bytes(target: Path, write: Callable[[BinaryIO], object]) -> StagedFile:
    """Has a function write into a file beside its target.

    Raises:
        OSError: The file cannot be written.
    """

    def write_new(path: Path) -> None:
        with path.open("xb") as file:
            write(file)

    return stage_with(target, write_new)


def stage_folder(target: Path, write: Callable[[Path], object]) -> StagedFolder:
    """Has a function write a file under its own name, and others with it, beside its target.

    Raises:
        OSError: The file cannot be written.
    """
    recover(target.parent)
    staged = StagedFolder(beside(target, ""), target)
    staged.temporary.mkdir()
    try:
        write(staged.temporary / target.name)
        if not (staged.temporary / target.name).exists():
            raise OSError(f"'{target}' was not written")
    except BaseException:
        staged.discard()
        raise
    return staged


def write_output(output: Path | BinaryIO, write: Callable[[BinaryIO], object]) -> None:
    """Has a function write what `as_output` returned: an open file, or one that is replaced."""
    if not isinstance(output, Path):
        write(output)
        return
    staged = stage_bytes(output, write)
    try:
        staged.commit()
    except BaseException:
        staged.discard()
        raise


def commit_all(files: Sequence[StagedFile]) -> None:
    """Renames files into place: all of them, or none.

    Where the program is killed in between, the next one that stages a file in a folder of theirs
    puts the earlier files back.

    Raises:
        OSError: One cannot be put into place, and the others are as they were; but for those that
            the message names.
    """
    for folder in dict.fromkeys(file.target.parent for file in files):
        recover(folder)
    if len(files) < 2:
        for file in files:
            file.commit()
        return
    kept: list[Kept] = []
    with ExitStack() as stack:
        try:
            for file in files:
                kept.append((file.target, second_name(file.target)))
            stack.enter_context(journal(kept, [file.temporary for file in files]))
            for file in files:
                file.commit()
        except BaseException as error:
            lost = [text for target, earlier in kept if (text := put_back(target, earlier))]
            if lost:
                raise OSError("; ".join([str(error), *lost])) from error
            raise
    for _, earlier in kept:
        if earlier is not None:
            earlier.unlink(missing_ok=True)


def as_output(path: Output) -> Path | BinaryIO:
    """An open file as it is; else what `as_target` returns."""
    if hasattr(path, "write"):
        return cast(BinaryIO, path)
    return as_target(path)


def as_target(path: str | os.PathLike[str]) -> Path:
    """The regular file that a path stands for, or will, if it can be written.

    Symbolic links are followed: what they lead to is replaced.

    Raises:
        ValueError: That is no path.
        OSError: See `check_target`.
    """
    given = as_path(path)
    check_regular(Path(given), "path: ")
    target = Path(os.path.realpath(given))
    check_target(target, "path: ")
    return target


def check_target(target: Path, who: str = "") -> None:
    """Raises OSError if a file has no folder, or `check_writable` does; `who` begins the text."""
    if not target.parent.is_dir():
        raise OSError(f"{who}there is no folder '{target.parent}'")
    check_writable(target, who)


def check_writable(path: Path, who: str = "") -> None:
    """Raises OSError if a file or its folder is read-only, or if it is no regular file.

    Root may write what has no write bits; a path without them is left alone all the same.
    """
    check_regular(path, who)
    if path.exists() and not _is_writable(path):
        raise OSError(f"{who}'{path}' is read-only")
    if not _is_writable(path.parent):
        raise OSError(f"{who}'{path}': its folder is read-only")


def check_regular(path: Path, who: str = "") -> None:
    """Raises OSError for what is there and is no regular file: a file renamed would replace it."""
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return
    if not stat.S_ISREG(mode):
        kind = _KINDS.get(stat.S_IFMT(mode), "device")
        raise OSError(f"{who}'{path}' is a {kind}; a regular file, or a new one, is needed")


def _is_writable(path: Path) -> bool:
    if os.name == "nt" and path.is_dir():
        # What marks folders there as read-only means that they have a look of their own.
        return True
    return os.access(path, os.W_OK) and bool(path.stat().st_mode & _WRITE_BITS)
