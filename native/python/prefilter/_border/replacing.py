# SPDX-License-Identifier: GPL-3.0-or-later

"""Files renamed over others: how that is undone, by who did it, or by the next run after a kill.

Several files cannot be renamed at once. So while a set is put into place, a journal beside it says
under which names the earlier files are kept. Who is killed in between leaves it there, and whoever
writes into the folder next puts the earlier files back.
"""

import json
import os
import shutil
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

Kept = tuple[Path, Path | None]
"""A target, and the second name of the file that was there; None where there was none."""

_JOURNAL = ".set"


def beside(target: Path, suffix: str | None = None) -> Path:
    """Returns a name in the folder of a target that nobody else thinks of, with its suffix."""
    ending = target.suffix if suffix is None else suffix
    return target.with_name(f".prefilter-{os.urandom(4).hex()}{ending}")


def rename(new: Path, target: Path) -> None:
    """Renames a file, over another one if there is one."""
    try:
        os.replace(new, target)
    except PermissionError as error:
        if os.name == "nt" and target.exists():
            message = f"'{target}' cannot be replaced: another program has it open"
            raise OSError(message) from error
        raise


def second_name(target: Path) -> Path | None:
    """Gives a file a second name that outlasts its replacement; None where there is no file."""
    if not target.exists():
        return None
    other = beside(target)
    try:
        os.link(target, other)
    except OSError:  # Some file systems have no links.
        shutil.copy2(target, other)
    return other


def put_back(target: Path, earlier: Path | None) -> str:
    """Undoes a replacement; returns what is to be told where that fails, else nothing."""
    try:
        if earlier is None:
            target.unlink(missing_ok=True)
        else:
            rename(earlier, target)
            # Renaming does nothing where both are still names of one file.
            earlier.unlink(missing_ok=True)
    except OSError as error:
        kept = "" if earlier is None else f"; the earlier file is kept as '{earlier}'"
        return f"'{target}' was written, which cannot be undone{kept}: {error}"
    return ""


@contextmanager
def journal(kept: Sequence[Kept], written: Iterable[Path]) -> Iterator[None]:
    """Has the next run undo replacements if this one is killed before the context ends.

    Args:
        kept: What is about to be replaced.
        written: The new files under their temporary names, which then are removed.
    """
    folders = list(dict.fromkeys(target.parent for target, _ in kept))
    first = folders[0]
    text = {
        "kept": [[_said(target, first), _said(earlier, first)] for target, earlier in kept],
        "written": [_said(path, first) for path in written],
    }
    begun = [_begun(first, text)]
    try:
        # Whoever writes into another folder of the set finds the way from there.
        begun += [_begun(folder, {"see": str(begun[0][0])}) for folder in folders[1:]]
        yield
    finally:
        for path, file in begun:  # Once the first has ended, the set is there.
            _end(path, file)


def recover(folder: Path) -> None:
    """Undoes what runs have left half done that were killed while they replaced files."""
    try:
        found = [Path(one) for one in os.scandir(folder) if one.name.endswith(_JOURNAL)]
    except OSError:
        return
    for path in found:
        if path.name.startswith(".prefilter-"):
            _undo(path)


def _begun(folder: Path, text: dict[str, object]) -> tuple[Path, BinaryIO]:
    """Writes a journal, which stays locked, so that others know that its writer lives."""
    while True:
        path = beside(folder / "set", _JOURNAL)
        file = path.open("xb")
        with suppress(OSError):  # Some file systems have no locks.
            _lock(file, waits=True)
        file.write(json.dumps(text).encode())
        file.flush()
        if path.exists():  # Else somebody has removed it as one that nobody has locked.
            return path, file
        file.close()


def _end(path: Path, file: BinaryIO) -> None:
    """Ends a journal: an empty one undoes nothing."""
    file.truncate(0)
    file.close()
    path.unlink(missing_ok=True)


def _undo(path: Path) -> None:
    """Does what a journal says, unless its writer lives; one that is damaged was not in use yet."""
    try:
        file = path.open("r+b")
    except OSError:
        return
    with file:
        try:
            _lock(file, waits=False)
            text = json.loads(file.read() or b"{}")
        except OSError:
            return
        except ValueError:
            text = {}
        failed = [
            told
            for target, earlier in text.get("kept", [])
            if (told := _put_back_again(path.parent, target, earlier))
        ]
        for name in text.get("written", []):
            (path.parent / name).unlink(missing_ok=True)
        if "see" in text:
            _undo(Path(text["see"]))
        if failed:
            raise OSError("; ".join(failed))
        file.truncate(0)
    with suppress(OSError):
        path.unlink()


def _put_back_again(folder: Path, target: str, earlier: str | None) -> str:
    """Undoes one replacement; one that was undone before has no second name left."""
    if earlier is None:
        return put_back(folder / target, None)
    if not (folder / earlier).exists():
        return ""
    return put_back(folder / target, folder / earlier)


def _said(path: Path | None, folder: Path) -> str | None:
    """Returns how a journal in a folder calls a file; folders may be moved."""
    if path is None:
        return None
    return path.name if path.parent == folder else str(path.absolute())


def _lock(file: BinaryIO, *, waits: bool) -> None:
    """Locks a file until it is closed; raises OSError where another process has done so."""
    if sys.platform == "win32":
        msvcrt.locking(file.fileno(), msvcrt.LK_LOCK if waits else msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if waits else fcntl.LOCK_NB))
