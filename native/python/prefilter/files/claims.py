# SPDX-License-Identifier: GPL-3.0-or-later

"""Lock files for temporary names in a folder, and removal of files that dead processes left there.

A claim is a file that stays locked while its process lives. It owns all files named like it with a
number appended; whoever can lock the claim may remove them. A temporary file without a claim is
locked itself. Locks may hold for one machine only, so temporary names contain the machine.
"""

import os
import re
import shutil
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from .._native import MACHINE_DIGITS, random_name

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

CLAIM, JOURNAL = ".lock", ".set"
"""Extensions of claims. A journal also holds recovery steps to take before it is removed."""

_STEM = re.compile(r"\.prefilter-([0-9a-f]+)")
_SECONDS_ELSEWHERE = 24 * 3600.0

Recover = Callable[[Path, BinaryIO], bool]
"""Carries out the recovery steps of a claim's file; returns whether its files can be removed."""


def is_temporary(path: Path) -> bool:
    """Tells whether a path is a temporary file, or inside a temporary folder."""
    return any(_STEM.match(part) for part in path.parts)


class Claim:
    """A lock file that reserves temporary names in a folder; raises OSError if not possible."""

    def __init__(self, folder: Path, ending: str = CLAIM) -> None:
        """Creates the file and locks it, if the file system has locks."""
        self._numbers = iter(range(1 << 62))
        while True:
            self.path = folder / f"{random_name()}{ending}"
            self._file = self.path.open("xb", buffering=0)
            with suppress(OSError):
                _lock(self._file, waits=True)
            if self.path.exists():  # Another process may have swept it before it was locked.
                return
            self._file.close()

    def new_name(self, suffix: str) -> Path:
        """Returns an unused name that this claim owns."""
        return self.path.with_name(f"{self.path.stem}-{next(self._numbers)}{suffix}")

    def write_journal(self, text: bytes) -> None:
        """Writes recovery steps in case this process is killed, and syncs them to disk."""
        while text:
            text = text[self._file.write(text) :]
        os.fsync(self._file.fileno())

    def clear_journal(self) -> None:
        """Empties the journal and syncs that to disk: nothing is left to recover."""
        self._file.truncate(0)
        os.fsync(self._file.fileno())

    def end(self) -> None:
        """Removes the claim; its temporary files must be gone by then."""
        self._file.close()
        self.path.unlink(missing_ok=True)

    def abandon(self) -> None:
        """Unlocks the claim but leaves its files, so that the next run recovers them."""
        self._file.close()


class _Shared:
    """One reference-counted claim per folder, shared by its staged files."""

    def __init__(self) -> None:
        self._guard = threading.Lock()
        self._held: dict[Path, tuple[Claim, int]] = {}

    def take(self, folder: Path) -> Claim:
        with self._guard:
            claim, count = self._held.get(folder) or (Claim(folder), 0)
            self._held[folder] = claim, count + 1
            return claim

    def give_back(self, folder: Path) -> None:
        with self._guard:
            claim, count = self._held.pop(folder)
            if count > 1:
                self._held[folder] = claim, count - 1
                return
            claim.end()


_shared = _Shared()
take, give_back = _shared.take, _shared.give_back


@contextmanager
def temporary_folder(parent: str | os.PathLike[str] | None = None) -> Iterator[Path]:
    """A context that yields a new folder and removes it at the end.

    After a kill, the next call removes it.

    Args:
        parent: The folder to create it in; None for the system's temporary folder.
    """
    import tempfile

    place = Path(tempfile.gettempdir() if parent is None else parent)
    sweep(place)
    claim = take(place)
    try:
        folder = claim.new_name("")
        folder.mkdir(mode=0o700)
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    finally:
        give_back(place)


def sweep(folder: Path, recover: Recover = lambda path, file: path.suffix != JOURNAL) -> None:
    """Removes files that dead processes left in a folder; in doubt, leaves them."""
    owned: dict[str, list[Path]] = {}
    try:
        for entry in os.scandir(folder):
            if match := _STEM.match(entry.name):
                owned.setdefault(match[0], []).append(Path(entry))
    except OSError:
        return
    for paths in owned.values():
        held = [path for path in paths if path.suffix in (CLAIM, JOURNAL)]
        for path in held:
            sweep_claim(path, recover)
        if not held and sys.platform != "win32":  # Windows removes them with their process.
            for path in paths:
                _sweep_own(path)


def sweep_claim(path: Path, recover: Recover) -> bool:
    """Recovers and removes a claim and its files if its process is dead; returns whether it is
    gone.

    Raises:
        OSError: A recovery step fails.
    """
    try:
        file = path.open("r+b")
    except FileNotFoundError:
        return True
    except OSError:
        return False
    with file:
        try:
            _lock(file, waits=False)
        except OSError:
            return False
        # Journals are recovered at once, whatever their machine: they live for moments only.
        if path.exists() and not (path.suffix == JOURNAL or _may_be_swept(path)):
            return False
        if not recover(path, file):
            return False
        for owned in path.parent.glob(f"{path.stem}-*"):
            _remove(owned)
        file.truncate(0)
    with suppress(OSError):
        path.unlink()
    return True


def _sweep_own(path: Path) -> None:
    """Removes an unlocked file, unless it has been renamed into place meanwhile."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | getattr(os, "O_NOFOLLOW", 0))
    except OSError:
        return
    with open(descriptor, "rb") as file, suppress(OSError):
        _lock(file, waits=False)
        if _may_be_swept(path) and os.path.samestat(path.lstat(), os.fstat(descriptor)):
            path.unlink()


def _may_be_swept(path: Path) -> bool:
    """Tells whether a free lock proves that the process is dead; on another machine it may not."""
    match = _STEM.match(path.name)
    assert match is not None
    half = MACHINE_DIGITS // 2
    own = random_name().removeprefix(".prefilter-")
    if match[1][:half] == own[:half] or match[1][half:MACHINE_DIGITS] == own[half:MACHINE_DIGITS]:
        return True
    with suppress(OSError):
        return time.time() - path.stat().st_mtime > _SECONDS_ELSEWHERE
    return False


def _remove(path: Path) -> None:
    with suppress(OSError):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()


def lock_new(file: BinaryIO) -> None:
    """Locks a nameless file, so that it counts as in use once it has a name."""
    with suppress(OSError):
        _lock(file, waits=False)


def _lock(file: BinaryIO, *, waits: bool) -> None:
    """Locks a file until it is closed; raises OSError if another process holds the lock."""
    if sys.platform == "win32":
        msvcrt.locking(file.fileno(), msvcrt.LK_LOCK if waits else msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if waits else fcntl.LOCK_NB))
