# SPDX-License-Identifier: GPL-3.0-or-later

"""Replacing several files all or none, with undo on failure and recovery after a kill.

Several files cannot be renamed at once. So while a set is put into place, a journal beside it lists
the backup names of the earlier files. A killed process leaves the journal, and the next one that
writes into the folder restores the earlier files. Each step is synced to disk before the next one
relies on it, so recovery works after a power failure too.
"""

import json
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from .claims import JOURNAL, Claim, sweep, sweep_claim

Backup = tuple[Path, Path | None]
"""A target, and the backup of the file that was there; None if there was none."""


def rename(new: Path, target: Path) -> None:
    """Renames a file, replacing the target if it exists."""
    try:
        os.replace(new, target)
    except PermissionError as error:
        if os.name == "nt" and target.exists():
            message = f"'{target}' cannot be replaced: another program has it open"
            raise OSError(message) from error
        raise


def sync(path: Path) -> None:
    """Syncs a file or folder to disk; for folders, systems without support are tolerated.

    Raises:
        OSError: The disk has no room for the file's data.
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
def restored_on_failure(pairs: Sequence[tuple[Path, Path]]) -> Iterator[None]:
    """A context whose replacements of files are all undone if it fails.

    Args:
        pairs: The new files under their temporary names, and their targets.

    Raises:
        OSError: The journal cannot be written; or the context has failed, and the replacements that
            the message lists cannot be undone.
    """
    folders = list(dict.fromkeys(target.parent for _, target in pairs))
    with _claimed(folders) as claims:
        backups: list[Backup] = []
        try:
            for _, target in pairs:
                backups.append((target, _back_up(target, claims[target.parent])))
            _write_journals(claims, pairs, backups)
            yield
            for folder in folders:
                sync(folder)
            claims[folders[0]].clear_journal()  # The whole set is in place.
        except BaseException as error:
            lost = [text for target, earlier in backups if (text := _restore(target, earlier))]
            if lost:
                for claim in claims.values():
                    claim.abandon()
                claims.clear()
                raise OSError("; ".join([str(error), *lost])) from error
            raise
        for _, earlier in backups:
            if earlier is not None:
                earlier.unlink(missing_ok=True)


def link_or_copy(path: Path, other: Path) -> None:
    """Creates a hard link to a file, or a synced copy where links are not possible."""
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
    """Undoes unfinished replacements of killed processes and removes their temporary files.

    Raises:
        OSError: Files cannot be restored.
    """
    sweep(folder, _undo)


@contextmanager
def _claimed(folders: Sequence[Path]) -> Iterator[dict[Path, Claim]]:
    """A context that yields one journal per folder and ends those still in the mapping."""
    claims: dict[Path, Claim] = {}
    try:
        for folder in folders:
            claims[folder] = Claim(folder, JOURNAL)
        yield claims
    finally:
        for claim in reversed(claims.values()):  # Other journals refer to the first.
            claim.end()


def _write_journals(
    claims: dict[Path, Claim], pairs: Sequence[tuple[Path, Path]], backups: Sequence[Backup]
) -> None:
    """Writes the journals and syncs them and their folders to disk."""
    first, *others = claims.values()
    place = first.path.parent
    entries = [
        [_journal_path(target, place), _journal_path(earlier, place), _identity(new)]
        for (new, _), (target, earlier) in zip(pairs, backups, strict=True)
    ]
    first.write_journal(json.dumps({"kept": entries}).encode())
    # The journals in the other folders point to the first one.
    for claim in others:
        claim.write_journal(json.dumps({"see": str(first.path)}).encode())
    for folder in claims:
        sync(folder)


def _back_up(target: Path, claim: Claim) -> Path | None:
    """Backs a file up under a name that outlasts its replacement; None if there is no file."""
    if not target.exists():
        return None
    other = claim.new_name(target.suffix)
    link_or_copy(target, other)
    return other


def _restore(target: Path, earlier: Path | None) -> str:
    """Undoes a replacement; returns an error message if that fails, else an empty text."""
    try:
        if earlier is None:
            target.unlink(missing_ok=True)
        elif target.exists() and target.samefile(earlier):
            earlier.unlink()  # The target was not replaced yet.
        else:
            rename(earlier, target)
    except OSError as error:
        backup = "" if earlier is None else f"; the earlier file is kept as '{earlier}'"
        return f"'{target}' was written, which cannot be undone{backup}: {error}"
    return ""


def _undo(path: Path, file: BinaryIO) -> bool:
    """Carries out a journal; a damaged one was not in use yet."""
    if path.suffix != JOURNAL:
        return True
    try:
        text = json.loads(file.read() or b"{}")
    except ValueError:
        text = {}
    failed = [
        message
        for target, earlier, identity in text.get("kept", [])
        if (message := _restore_unless_changed(path.parent, target, earlier, identity))
    ]
    if failed:
        raise OSError("; ".join(failed))
    return "see" not in text or sweep_claim(Path(text["see"]), _undo)


def _restore_unless_changed(
    folder: Path, target: str, earlier: str | None, identity: Sequence[int]
) -> str:
    """Undoes one replacement, unless that is done already or the target has changed since."""
    with suppress(OSError):
        if _identity(folder / target) == list(identity):
            if earlier is None:
                return _restore(folder / target, None)
            if (folder / earlier).exists():
                return _restore(folder / target, folder / earlier)
    return ""


def _identity(path: Path) -> list[int]:
    """Returns values that identify a file even after a move: size and modification time."""
    status = path.stat()
    return [status.st_size, status.st_mtime_ns]


def _journal_path(path: Path | None, folder: Path) -> str | None:
    """Returns a file's path for a journal; relative to its folder, which may be moved."""
    if path is None:
        return None
    return path.name if path.parent == folder else str(path.absolute())
