# SPDX-License-Identifier: GPL-3.0-or-later

"""Files staged beside their target and renamed into place, so that nobody sees half-written ones.

The package and the add-on write all files this way, except those that the library streams.
"""

import os
import shutil
import stat
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, cast

from .._border import stopping
from .._border.input import as_path
from .._native import random_name
from . import claims
from .replacing import link_or_copy, recover, rename, restored_on_failure, sync

Output = str | os.PathLike[str] | BinaryIO

_WRITE_BITS = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH
_KINDS = {stat.S_IFDIR: "folder", stat.S_IFIFO: "pipe", stat.S_IFSOCK: "socket"}
_NEW_MODE = 0o666  # Before the user's umask.
_nameless_slots = threading.BoundedSemaphore(64)
"""Nameless files have to stay open, and a process may have only about a thousand open files."""


class StagedFile:
    """A finished file in the folder of its target, under a temporary name or nameless."""

    def __init__(
        self, target: Path, named: Path | None = None, nameless: BinaryIO | None = None
    ) -> None:
        """Takes a file that is on disk.

        Args:
            target: The path that it will get.
            named: Its temporary name, owned by the claim on the target's folder.
            nameless: The open file, if it has no name.
        """
        self.target = target
        self._name = named
        self._is_claimed = named is not None
        self._nameless = nameless

    def commit(self) -> None:
        """Puts the file into place; a replaced file's mode is kept."""
        commit_all([self])

    def name(self) -> Path:
        """Returns the temporary name, after giving the file one if it is nameless."""
        if self._name is None:
            assert self._nameless is not None
            path = self.target.with_name(random_name() + self.target.suffix)
            # The link in /proc has to be followed, which os.link does only with src_dir_fd.
            anywhere = os.open(self.target.parent, os.O_RDONLY)
            try:
                with _naming_target(self.target, {path: self.target}):
                    os.link(_own_link(self._nameless), path, src_dir_fd=anywhere)
            finally:
                os.close(anywhere)
            self._name = path
        return self._name

    def put(self) -> None:
        """Renames the file into place."""
        check_regular(self.target)
        name = self.name()
        with _naming_target(self.target, {name: self.target}):
            if self.target.exists():
                shutil.copymode(self.target, name)
            rename(name, self.target)

    def discard(self) -> None:
        """Removes the temporary file, if it is still there."""
        if self._name is not None:
            self._name.unlink(missing_ok=True)
        if self._nameless is not None:
            with suppress(OSError):  # Errors of buffered data no longer matter.
                self._nameless.close()
            self._nameless = None
            _nameless_slots.release()
        if self._is_claimed:
            self._is_claimed = False
            claims.give_back(self.target.parent)


class StagedFolder:
    """A finished file and its companions, in a temporary folder beside its target."""

    def __init__(self, target: Path, folder: Path) -> None:
        """Takes a folder whose name the claim on the target's folder owns."""
        self.target = target
        self._folder = folder
        self._is_claimed = True

    def make(self, write: Callable[[Path], object]) -> None:
        """Calls a function that writes the files."""
        main_file = self._folder / self.target.name
        with _naming_target(self.target, {self._folder: self.target.parent}):
            self._folder.mkdir()
            write(main_file)
            if not main_file.exists():
                raise OSError(f"'{self.target}' was not written")
            for path in self._folder.iterdir():
                sync(path)

    def commit(self) -> None:
        """Moves the files into place, the target last, and removes the folder."""
        written = sorted(self._folder.iterdir(), key=lambda path: path.name == self.target.name)
        commit_all([_InFolder(self.target.with_name(path.name), path) for path in written])
        self.discard()

    def discard(self) -> None:
        """Removes the temporary folder."""
        shutil.rmtree(self._folder, ignore_errors=True)
        if self._is_claimed:
            self._is_claimed = False
            claims.give_back(self.target.parent)


class _InFolder(StagedFile):
    """A file in a temporary folder, which is removed with that folder."""

    def __init__(self, target: Path, named: Path) -> None:
        super().__init__(target, named)
        self._is_claimed = False


def stage_with(
    target: Path, write: Callable[[Path], object], suffix: str | None = None
) -> StagedFile:
    """Stages a file that a function writes, given a path beside the target.

    Args:
        target: The path that the file will get.
        write: Writes a new file.
        suffix: Extension of the temporary path; None for that of the target.

    Raises:
        OSError: The file cannot be written.
    """
    recover(target.parent)
    with _naming_target(target, {}):
        claim = claims.take(target.parent)
    staged = StagedFile(target, claim.new_name(target.suffix if suffix is None else suffix))
    try:
        with _naming_target(target, {staged.name(): target}):
            write(staged.name())
            sync(staged.name())
    except BaseException:
        staged.discard()
        raise
    return staged


def stage_bytes(target: Path, write: Callable[[BinaryIO], object]) -> StagedFile:
    """Stages a file that a function writes into an open file, nameless where the system allows it.

    Raises:
        OSError: The file cannot be written.
    """
    nameless = _nameless(target.parent)
    if nameless is None:
        return stage_with(target, lambda path: _write_new(path, write))
    staged = StagedFile(target, nameless=nameless)
    try:
        recover(target.parent)
        with _naming_target(target, {}):
            write(nameless)
            nameless.flush()
            os.fsync(nameless.fileno())
    except BaseException:
        staged.discard()
        raise
    return staged


def stage_data(target: Path, data: bytes) -> StagedFile:
    """Stages a file with these bytes, as `stage_bytes` does."""
    return stage_bytes(target, lambda file: file.write(data))


def stage_folder(target: Path, write: Callable[[Path], object]) -> StagedFolder:
    """Stages a file, and others with it, that a function writes into a temporary folder.

    Raises:
        OSError: The file cannot be written.
    """
    recover(target.parent)
    with _naming_target(target, {}):
        claim = claims.take(target.parent)
    staged = StagedFolder(target, claim.new_name(""))
    try:
        staged.make(write)
    except BaseException:
        staged.discard()
        raise
    return staged


def stage_link(path: Path, other: Path) -> StagedFile:
    """Stages a link or copy of a file under another name in the same folder.

    Raises:
        OSError: That is not possible.
    """
    return stage_with(other, lambda new: link_or_copy(path, new))


def write_output(output: Path | BinaryIO, write: Callable[[BinaryIO], object]) -> None:
    """Calls a function to write into an open file, or into a new one that replaces `output`."""
    if not isinstance(output, Path):
        write(output)
        return
    staged = stage_bytes(output, write)
    try:
        staged.commit()
    finally:
        staged.discard()


def commit_all(files: Sequence[StagedFile]) -> None:
    """Renames files into place: all of them, or none.

    If the process is killed in between, the next one that stages a file in one of their folders
    restores the earlier files.

    Raises:
        OSError: A file cannot be put into place. The others are restored, except those that the
            message names.
    """
    folders = list(dict.fromkeys(file.target.parent for file in files))
    with stopping.held():
        for folder in folders:
            recover(folder)
        if len(files) == 1:
            files[0].put()
            sync(folders[0])
        elif files:
            with (
                _naming_target(files[-1].target, {}),
                restored_on_failure([(file.name(), file.target) for file in files]),
            ):
                for file in files:
                    file.put()
        for file in files:
            file.discard()


def as_output(path: Output) -> Path | BinaryIO:
    """Returns an open file as it is, and `as_target` of a path."""
    if hasattr(path, "write"):
        return cast(BinaryIO, path)
    return as_target(path)


def as_target(path: str | os.PathLike[str]) -> Path:
    """Returns the absolute path of a regular or new file that can be written.

    Symbolic links are followed: the file they lead to will be replaced.

    Raises:
        ValueError: The argument is no path.
        OSError: See `check_target`.
    """
    name = as_path(path)
    check_regular(Path(name), "path: ")
    target = Path(os.path.realpath(name))
    check_target(target, "path: ")
    return target


def check_target(target: Path, who: str = "") -> None:
    """Raises OSError if the folder is missing, or as `check_writable`; `who` starts the message."""
    if not target.parent.is_dir():
        raise OSError(f"{who}there is no folder '{target.parent}'")
    check_writable(target, who)


def check_writable(path: Path, who: str = "") -> None:
    """Raises OSError if a file or its folder is read-only, or if it is no regular file.

    A path without write bits counts as read-only even for root.
    """
    check_regular(path, who)
    if path.exists() and not _is_writable(path):
        raise OSError(f"{who}'{path}' is read-only")
    if not _is_writable(path.parent):
        raise OSError(f"{who}'{path}': its folder is read-only")


def check_regular(path: Path, who: str = "") -> None:
    """Raises OSError if the path exists and is no regular file, which renaming would replace."""
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return
    if not stat.S_ISREG(mode):
        kind = _KINDS.get(stat.S_IFMT(mode), "device")
        raise OSError(f"{who}'{path}' is a {kind}; a regular file, or a new one, is needed")


@contextmanager
def _naming_target(target: Path, names: Mapping[Path, Path]) -> Iterator[None]:
    """A context in which errors name the target instead of its temporary files.

    Args:
        target: The path to name in errors of the system that name nothing or a temporary file.
        names: Temporary files or folders, and the paths that messages show instead.
    """
    try:
        yield
    except OSError as error:
        if error.errno is not None:
            named = [Path(name) for name in (error.filename, error.filename2) if name]
            if named and not any(map(claims.is_temporary, named)):
                raise
            raise OSError(error.errno, error.strerror, os.fspath(target)) from error
        text = str(error)
        for temporary, other in names.items():
            text = text.replace(os.fspath(temporary), os.fspath(other))
            text = text.replace(temporary.name, other.name)
        if text == str(error):
            raise
        raise OSError(text) from error


def _is_writable(path: Path) -> bool:
    if os.name == "nt" and path.is_dir():
        # The read-only attribute of Windows folders only marks a custom appearance.
        return True
    return os.access(path, os.W_OK) and bool(path.stat().st_mode & _WRITE_BITS)


def _nameless(folder: Path) -> BinaryIO | None:
    """Opens a nameless file, deleted on close unless it gets a name; None if not supported."""
    if not hasattr(os, "O_TMPFILE") or not _nameless_slots.acquire(blocking=False):
        return None
    try:
        file = os.fdopen(os.open(folder, os.O_TMPFILE | os.O_RDWR, _NEW_MODE), "w+b")
    except OSError:
        _nameless_slots.release()
        return None
    claims.lock_new(file)
    if os.path.exists(_own_link(file)):
        return file
    file.close()
    _nameless_slots.release()
    return None


def _own_link(file: BinaryIO) -> str:
    return f"/proc/self/fd/{file.fileno()}"


def _write_new(path: Path, write: Callable[[BinaryIO], object]) -> None:
    with path.open("xb") as file:
        write(file)
