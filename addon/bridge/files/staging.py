# SPDX-License-Identifier: GPL-3.0-or-later

"""Files staged beside their target and renamed into place, so that no half-written one is seen."""

import os
import secrets
import shutil
import stat
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

_WRITE_BITS = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH


@dataclass(frozen=True)
class StagedFile:
    """A finished file under a temporary name, in the folder of its target."""

    temporary: Path
    target: Path

    def commit(self) -> None:
        """Renames the file into place; it gets the mode of a file that it replaces."""
        if self.target.exists():
            shutil.copymode(self.target, self.temporary)
        _rename(self.temporary, self.target)

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


def commit_all(files: Sequence[StagedFile]) -> None:
    """Renames files into place: all of them, or none.

    Raises:
        OSError: One cannot be put into place, and the others are as they were; but for those that
            the message names.
    """
    if len(files) == 1:
        files[0].commit()
        return
    kept: list[tuple[Path, Path | None]] = []
    try:
        for file in files:
            kept.append((file.target, _second_name(file.target)))
            file.commit()
    except BaseException as error:
        lost = [text for target, earlier in kept if (text := _put_back(target, earlier))]
        if lost:
            raise OSError("; ".join([str(error), *lost])) from error
        raise
    for _, earlier in kept:
        if earlier is not None:
            earlier.unlink(missing_ok=True)


def _rename(new: Path, target: Path) -> None:
    try:
        os.replace(new, target)
    except PermissionError as error:
        if os.name == "nt" and target.exists():
            message = f"file '{target}' cannot be replaced: another program has it open"
            raise OSError(message) from error
        raise


def _second_name(target: Path) -> Path | None:
    """Gives a file a second name that outlasts its replacement; None where there is no file."""
    if not target.exists():
        return None
    other = target.with_name(f".prefilter-{secrets.token_hex(4)}{target.suffix}")
    try:
        os.link(target, other)
    except OSError:  # Some file systems have no links.
        shutil.copy2(target, other)
    return other


def _put_back(target: Path, earlier: Path | None) -> str:
    """Undoes a replacement; returns what is to be told where that fails, else nothing."""
    try:
        if earlier is None:
            target.unlink(missing_ok=True)
        else:
            _rename(earlier, target)
            # Renaming does nothing where both are still names of one file.
            earlier.unlink(missing_ok=True)
    except OSError as error:
        kept = "" if earlier is None else f"; the earlier file is kept as '{earlier}'"
        return f"file '{target}' was written and cannot be taken back{kept}: {error}"
    return ""


def check_plain_target(path: str, ending: str) -> Path:
    """Returns the absolute path of a file that can be written, and whose name ends as needed.

    Raises:
        ValueError: The name does not end in `ending`.
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    if target.suffix.lower() != ending:
        raise ValueError(f"file '{path}': unsupported extension '{target.suffix}'; use {ending}")
    check_place(path, target)
    return target


def check_output(path: str) -> Path:
    """Returns the absolute path of a file of any kind that can be written.

    Raises:
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    check_place(path, target)
    return target


def stage_folder(target: Path, write: Callable[[Path], object]) -> StagedFolder:
    """Has a function write a file under its own name, and others with it, beside its target.

    Raises:
        OSError: The file cannot be written.
    """
    staged = StagedFolder(target.with_name(f".prefilter-{secrets.token_hex(4)}"), target)
    staged.temporary.mkdir()
    try:
        write(staged.temporary / target.name)
        if not (staged.temporary / target.name).exists():
            raise OSError(f"file '{target}': Blender did not write it")
    except BaseException:
        staged.discard()
        raise
    return staged


def stage_with(target: Path, write: Callable[[Path], object]) -> StagedFile:
    """Has a function write a file beside its target.

    Raises:
        OSError: The file cannot be written.
    """
    staged = _staged(target)
    try:
        write(staged.temporary)
    except BaseException:
        staged.discard()
        raise
    return staged


def check_writable(path: Path) -> None:
    """Raises OSError if a file or its folder is read-only, or if it is no regular file.

    Root may write what has no write bits; a path without them is left alone all the same. A device
    or a pipe would not be written to, but replaced.
    """
    if path.is_dir():
        raise OSError(f"file '{path}' is a folder")
    if path.exists() and not path.is_file():
        raise OSError(f"file '{path}' is a device or a pipe; only regular files are replaced")
    if path.exists() and not _is_writable(path):
        raise OSError(f"file '{path}' is read-only")
    if not _is_writable(path.parent):
        raise OSError(f"file '{path}': its folder is read-only")


def check_place(path: str, target: Path) -> None:
    """Raises OSError unless a file can be written; `path` is what the user calls it."""
    if not target.parent.is_dir():
        raise OSError(f"file '{path}': there is no folder '{target.parent}'")
    check_writable(target)


def _staged(target: Path) -> StagedFile:
    name = f".prefilter-{secrets.token_hex(4)}{target.suffix}"
    return StagedFile(target.with_name(name), target)


def _is_writable(path: Path) -> bool:
    if os.name == "nt" and path.is_dir():
        # What marks folders there as read-only means that they have a look of their own.
        return True
    return os.access(path, os.W_OK) and bool(path.stat().st_mode & _WRITE_BITS)
