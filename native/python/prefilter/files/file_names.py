# SPDX-License-Identifier: GPL-3.0-or-later

"""Names of files: what each system allows in them, and which paths lead to one file."""

import ntpath
import os
import re
import unicodedata
from collections.abc import Hashable
from contextlib import suppress
from pathlib import PurePath

_FORBIDDEN = re.compile(r'[<>:"/\\|?*\x00-\x1f\x7f\ud800-\udfff]')
"""Characters that Windows forbids in names, and halves of characters that no system can show."""
_DEVICES = frozenset(
    ["con", "prn", "aux", "nul", "conin$", "conout$"]
    + [f"{device}{digit}" for device in ("com", "lpt") for digit in "0123456789¹²³"]
)
"""Names of devices in Windows, in small letters, whatever extension follows."""


def portable(name: str) -> str:
    """Returns a name of one part of a path that every system can write and reads the same.

    Characters that Windows forbids become "_", as do dots and spaces at the end; letters with
    accents are composed (NFC); "_" follows the names of Windows' devices.
    """
    composed = _FORBIDDEN.sub("_", unicodedata.normalize("NFC", name))
    bare = composed.rstrip(". ")
    composed = bare + "_" * (len(composed) - len(bare))
    stem, dot, rest = composed.partition(".")
    return f"{stem}_{dot}{rest}" if _is_device(stem) else composed


def check_windows_names(path: str, who: str = "", *, is_windows: bool = os.name == "nt") -> None:
    """Raises ValueError for a path to write that Windows reserves or forbids; elsewhere, never.

    Args:
        path: The path as it was given.
        who: Begins the text of the error.
        is_windows: Whether this system is Windows.
    """
    if not is_windows:
        return
    for part in re.split(r"[\\/]", ntpath.splitdrive(path)[1]):
        if part in ("", ".", ".."):
            continue
        name = portable(part)
        if name != unicodedata.normalize("NFC", part):
            raise ValueError(
                f"{who}'{path}': Windows does not allow the name '{part}'; '{name}' is allowed"
            )


def identities(path: str | os.PathLike[str]) -> set[Hashable]:
    """Returns all that tells a file from others: paths to one file have one of these in common.

    Symbolic links are followed; hard links, and names that differ in the case or in the composition
    of their letters, count as one file.
    """
    name = unicodedata.normalize("NFC", os.path.realpath(path))
    found: set[Hashable] = {unicodedata.normalize("NFC", name.casefold())}
    with suppress(OSError, ValueError):
        about = os.stat(path)
        if about.st_ino:
            found.add((about.st_dev, about.st_ino))
    return found


def stem_of(path: str) -> str:
    """Returns the name of a file without its folder and its last extension, as `portable`."""
    return portable(PurePath(path).stem)


def _is_device(stem: str) -> bool:
    return stem.rstrip(" ").lower() in _DEVICES
