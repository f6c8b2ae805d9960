# SPDX-License-Identifier: GPL-3.0-or-later

"""Files that are written beside their target and renamed."""

import os
import secrets
import shutil
import stat
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

_WRITE_BITS = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH


def as_path(path: str | os.PathLike[str]) -> str:
    try:
        given = os.fsdecode(path)
    except TypeError:
        given = "\0"
    if "\0" in given:
        raise ValueError(f"path: {path!r}; the path of a file is needed")
    return given


def as_target(path: str | os.PathLike[str]) -> Path:
    """The regular file that a path stands for, or will, if it can be written.

    Symbolic links are followed: `replace_file` replaces what they lead to. Root may write what has
    no write bits; that is left alone all the same.

    Raises:
        ValueError: That is no path.
        OSError: The file is a folder, a device or the like; or it, or its folder, is read-only; or
            there is no such folder.
    """
    given = as_path(path)
    _check_regular(given)
    target = Path(os.path.realpath(given))
    if not target.parent.is_dir():
        raise OSError(f"path: there is no folder '{target.parent}'")
    for place in (target, target.parent) if target.exists() else (target.parent,):
        if not _is_writable(place):
            raise OSError(f"path: '{place}' is read-only")
    return target


def replace_file(target: Path, write: Callable[[BinaryIO], object]) -> None:
    """Writes a file beside its target, and renames it; it gets the mode of one that it replaces."""
    new = target.with_name(f".prefilter-{secrets.token_hex(4)}{target.suffix}")
    try:
        with new.open("xb") as file:
            write(file)
        _check_regular(target)
        if target.exists():
            shutil.copymode(target, new)
        _rename(new, target)
    except BaseException:
        new.unlink(missing_ok=True)
        raise


def _is_writable(path: Path) -> bool:
    if os.name == "nt" and path.is_dir():
        # What marks folders there as read-only means that they have a look of their own.
        return True
    return os.access(path, os.W_OK) and bool(path.stat().st_mode & _WRITE_BITS)


def _rename(new: Path, target: Path) -> None:
    try:
        os.replace(new, target)
    except PermissionError as error:
        if os.name == "nt" and target.exists():
            message = f"path: '{target}' cannot be replaced: another program has it open"
            raise OSError(message) from error
        raise


def _check_regular(path: str | Path) -> None:
    """Raises OSError for what is there and is no regular file: a file renamed would replace it."""
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return
    if not stat.S_ISREG(mode):
        kinds = {stat.S_IFDIR: "folder", stat.S_IFIFO: "pipe", stat.S_IFSOCK: "socket"}
        kind = kinds.get(stat.S_IFMT(mode), "device")
        raise OSError(f"path: '{path}' is a {kind}; a regular file, or a new one, is needed")
