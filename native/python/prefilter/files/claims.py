# SPDX-License-Identifier: GPL-3.0-or-later

"""Names that a process has in a folder for the time being, and what dead processes have left there.

A claim is a file that stays locked while its process lives. It owns what has its name and a number,
so whoever can lock it may remove all that. A file without a claim is its own: it is locked itself.
Locks may hold for one machine only, so names say which one it was.
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
"""How claims end: a journal's file says what is to be done before it is removed."""

_STEM = re.compile(r"\.prefilter-([0-9a-f]+)")
_SECONDS_ELSEWHERE = 24 * 3600.0

End = Callable[[Path, BinaryIO], bool]
"""Does what the file of a claim says; returns whether all that it owns can go."""


def is_temporary(path: Path) -> bool:
    """Tells whether a name, or that of a folder it is in, is one of those."""
    return any(_STEM.match(part) for part in path.parts)


class Claim:
    """Names in a folder, of this process until it ends; raises OSError where it cannot write."""

    def __init__(self, folder: Path, ending: str = CLAIM) -> None:
        """Makes the file, and locks it, as far as the file system has locks."""
        self._numbers = iter(range(1 << 62))
        while True:
            self.path = folder / f"{random_name()}{ending}"
            self._file = self.path.open("xb", buffering=0)
            with suppress(OSError):
                _lock(self._file, waits=True)
            if self.path.exists():  # Else somebody has removed it as one that nobody has locked.
                return
            self._file.close()

    def beside(self, suffix: str) -> Path:
        """Returns a name that nobody else thinks of."""
        return self.path.with_name(f"{self.path.stem}-{next(self._numbers)}{suffix}")

    def say(self, text: bytes) -> None:
        """Has the disk hold what is to be done if this process is killed."""
        while text:
            text = text[self._file.write(text) :]
        os.fsync(self._file.fileno())

    def unsay(self) -> None:
        """Has the disk hold that nothing is to be done."""
        self._file.truncate(0)
        os.fsync(self._file.fileno())

    def end(self) -> None:
        """Gives the names back; files that have them are gone by then."""
        self._file.close()
        self.path.unlink(missing_ok=True)

    def leave(self) -> None:
        """Leaves the rest to the next run, as a dead process does."""
        self._file.close()


class _Shared:
    """The claims that staged files of one folder have in common, until the last of them ends."""

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
    """A new folder that is removed at the end of the context, or by the next one after a kill.

    Args:
        parent: Where; in the system's folder for temporary files if None.
    """
    import tempfile

    place = Path(tempfile.gettempdir() if parent is None else parent)
    sweep(place)
    claim = take(place)
    try:
        folder = claim.beside("")
        folder.mkdir(mode=0o700)
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    finally:
        give_back(place)


def sweep(folder: Path, end: End = lambda path, file: path.suffix != JOURNAL) -> None:
    """Removes what dead processes have left in a folder, and leaves what it cannot be sure of."""
    owned: dict[str, list[Path]] = {}
    try:
        for entry in os.scandir(folder):
            if found := _STEM.match(entry.name):
                owned.setdefault(found[0], []).append(Path(entry))
    except OSError:
        return
    for paths in owned.values():
        held = [path for path in paths if path.suffix in (CLAIM, JOURNAL)]
        for path in held:
            sweep_claim(path, end)
        if not held and sys.platform != "win32":  # There they go with their process.
            for path in paths:
                _sweep_own(path)


def sweep_claim(path: Path, end: End) -> bool:
    """Ends a claim and removes what it owns, unless its process lives; returns whether it is gone.

    Raises:
        OSError: What is to be done before cannot be done.
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
        # A journal counts at once, wherever it is from: its process replaces files for moments.
        if path.exists() and not (path.suffix == JOURNAL or _may_be_swept(path)):
            return False
        if not end(path, file):
            return False
        for owned in path.parent.glob(f"{path.stem}-*"):
            _remove(owned)
        file.truncate(0)
    with suppress(OSError):
        path.unlink()
    return True


def _sweep_own(path: Path) -> None:
    """Removes a file that nobody has locked; it may have been put into place meanwhile."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | getattr(os, "O_NOFOLLOW", 0))
    except OSError:
        return
    with open(descriptor, "rb") as file, suppress(OSError):
        _lock(file, waits=False)
        if _may_be_swept(path) and os.path.samestat(path.lstat(), os.fstat(descriptor)):
            path.unlink()


def _may_be_swept(path: Path) -> bool:
    """Tells whether a lock that can be had says enough: that of another machine may not."""
    found = _STEM.match(path.name)
    assert found is not None
    half = MACHINE_DIGITS // 2
    own = random_name().removeprefix(".prefilter-")
    if found[1][:half] == own[:half] or found[1][half:MACHINE_DIGITS] == own[half:MACHINE_DIGITS]:
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
    """Locks a file without a name, so that it is in use once it has one."""
    with suppress(OSError):
        _lock(file, waits=False)


def _lock(file: BinaryIO, *, waits: bool) -> None:
    """Locks a file until it is closed; raises OSError where another process has done so."""
    if sys.platform == "win32":
        msvcrt.locking(file.fileno(), msvcrt.LK_LOCK if waits else msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if waits else fcntl.LOCK_NB))
