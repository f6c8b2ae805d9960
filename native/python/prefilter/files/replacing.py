# SPDX-License-Identifier: GPL-3.0-or-later

"""Files renamed over others: how that is undone, by who did it, or by the next run after a kill.

Several files cannot be renamed at once. So while a set is put into place, a journal beside it says
under which names the earlier files are kept. Who is killed in between leaves it there, and whoever
writes into the folder next puts the earlier files back. Each step is on the disk before the next
one counts on it, so that holds where the power fails, too.
"""

import json
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from .claims import JOURNAL, Claim, sweep, sweep_claim

Kept = tuple[Path, Path | None]
"""A target, and the second name of the file that was there; None where there was none."""


def rename(new: Path, target: Path) -> None:
    """Renames a file, over another one if there is one."""
    try:
        os.replace(new, target)
    except PermissionError as error:
        if os.name == "nt" and target.exists():
            message = f"'{target}' cannot be replaced: another program has it open"
            raise OSError(message) from error
        raise


def sync(path: Path) -> None:
    """Has the disk hold what a file, or a folder, has; some systems cannot do that for folders.

    Raises:
        OSError: There is no room for what was written.
    """
    is_folder = path.is_dir()
    if is_folder and os.name == "nt":
        return
    descriptor = os.open(path, os.O_RDWR if os.name == "nt" else os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError:
        if not is_folder:
            raise
    finally:
        os.close(descriptor)


@contextmanager
def undone_on_failure(pairs: Sequence[tuple[Path, Path]]) -> Iterator[None]:
    """Replaces files, all of them or none: this undoes what was done in a context that fails.

    Args:
        pairs: The new files under their temporary names, and their targets.

    Raises:
        OSError: The journal cannot be written; or the context has failed, and what the message
            names cannot be undone.
    """
    folders = list(dict.fromkeys(target.parent for _, target in pairs))
    with _claimed(folders) as claims:
        kept: list[Kept] = []
        try:
            for _, target in pairs:
                kept.append((target, _second_name(target, claims[target.parent])))
            _begin(claims, pairs, kept)
            yield
            for folder in folders:
                sync(folder)
            claims[folders[0]].unsay()  # Now the set is there.
        except BaseException as error:
            lost = [text for target, earlier in kept if (text := _put_back(target, earlier))]
            if lost:
                for claim in claims.values():
                    claim.leave()
                claims.clear()
                raise OSError("; ".join([str(error), *lost])) from error
            raise
        for _, earlier in kept:
            if earlier is not None:
                earlier.unlink(missing_ok=True)


def link_or_copy(path: Path, other: Path) -> None:
    """Gives a file a second name, or where that cannot be has the disk hold it twice."""
    try:
        os.link(path, other)
    except OSError:
        try:
            shutil.copy2(path, other)
            sync(other)
        except BaseException:
            other.unlink(missing_ok=True)
            raise


def recover(folder: Path) -> None:
    """Undoes what runs have left half done that were killed, and removes what they have left.

    Raises:
        OSError: Files cannot be put back.
    """
    sweep(folder, _undo)


@contextmanager
def _claimed(folders: Sequence[Path]) -> Iterator[dict[Path, Claim]]:
    """Journals, one a folder, that end with the context, unless they are taken out before."""
    claims: dict[Path, Claim] = {}
    try:
        for folder in folders:
            claims[folder] = Claim(folder, JOURNAL)
        yield claims
    finally:
        for claim in reversed(claims.values()):  # Others refer to the first.
            claim.end()


def _begin(
    claims: dict[Path, Claim], pairs: Sequence[tuple[Path, Path]], kept: Sequence[Kept]
) -> None:
    """Has the disk hold the journals, and the names of all that they speak of."""
    first, *others = claims.values()
    place = first.path.parent
    entries = [
        [_said(target, place), _said(earlier, place), _identity(new)]
        for (new, _), (target, earlier) in zip(pairs, kept, strict=True)
    ]
    first.say(json.dumps({"kept": entries}).encode())
    # Whoever writes into another folder of the set finds the way from there.
    for claim in others:
        claim.say(json.dumps({"see": str(first.path)}).encode())
    for folder in claims:
        sync(folder)


def _second_name(target: Path, claim: Claim) -> Path | None:
    """Gives a file a second name that outlasts its replacement; None where there is no file."""
    if not target.exists():
        return None
    other = claim.beside(target.suffix)
    link_or_copy(target, other)
    return other


def _put_back(target: Path, earlier: Path | None) -> str:
    """Undoes a replacement; returns what is to be told where that fails, else nothing."""
    try:
        if earlier is None:
            target.unlink(missing_ok=True)
        elif target.exists() and target.samefile(earlier):
            earlier.unlink()  # It was not replaced, and perhaps cannot be.
        else:
            rename(earlier, target)
    except OSError as error:
        kept = "" if earlier is None else f"; the earlier file is kept as '{earlier}'"
        return f"'{target}' was written, which cannot be undone{kept}: {error}"
    return ""


def _undo(path: Path, file: BinaryIO) -> bool:
    """Does what a journal says; one that is damaged was not in use yet."""
    if path.suffix != JOURNAL:
        return True
    try:
        text = json.loads(file.read() or b"{}")
    except ValueError:
        text = {}
    failed = [
        told
        for target, earlier, identity in text.get("kept", [])
        if (told := _put_back_again(path.parent, target, earlier, identity))
    ]
    if failed:
        raise OSError("; ".join(failed))
    return "see" not in text or sweep_claim(Path(text["see"]), _undo)


def _put_back_again(folder: Path, target: str, earlier: str | None, identity: Sequence[int]) -> str:
    """Undoes one replacement, unless that was done before, or somebody has written there since."""
    with suppress(OSError):
        if _identity(folder / target) == list(identity):
            if earlier is None:
                return _put_back(folder / target, None)
            if (folder / earlier).exists():
                return _put_back(folder / target, folder / earlier)
    return ""


def _identity(path: Path) -> list[int]:
    """Returns what tells a file from others that it gets the name of, also after a move."""
    found = path.stat()
    return [found.st_size, found.st_mtime_ns]


def _said(path: Path | None, folder: Path) -> str | None:
    """Returns how a journal in a folder calls a file; folders may be moved."""
    if path is None:
        return None
    return path.name if path.parent == folder else str(path.absolute())
