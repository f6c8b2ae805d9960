"""Files that are written beside their target and renamed."""

import os
import secrets
import shutil
import stat
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

_WRITE_BITS = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH


def as_target(path: str | os.PathLike[str]) -> Path:
    """The file that a path stands for, symbolic links resolved, if it can be written.

    Root may write what has no write bits; that is left alone all the same.
    """
    try:
        target = Path(os.path.realpath(os.fsdecode(path)))
    except (TypeError, ValueError) as error:
        raise ValueError(f"path: {path!r}; the path of a file is needed") from error
    if not target.parent.is_dir():
        raise OSError(f"path: there is no folder '{target.parent}'")
    if target.is_dir():
        raise OSError(f"path: '{target}' is a folder")
    for place in (target, target.parent) if target.exists() else (target.parent,):
        writable = os.access(place, os.W_OK) and place.stat().st_mode & _WRITE_BITS
        if not writable:
            raise OSError(f"path: '{place}' is read-only")
    return target


def replace_file(target: Path, write: Callable[[BinaryIO], object]) -> None:
    """Writes a file beside its target, and renames it; it gets the mode of one that it replaces."""
    new = target.with_name(f".prefilter-{secrets.token_hex(4)}{target.suffix}")
    try:
        with new.open("xb") as file:
            write(file)
        if target.exists():
            shutil.copymode(target, new)
        os.replace(new, target)
    except BaseException:
        new.unlink(missing_ok=True)
        raise
