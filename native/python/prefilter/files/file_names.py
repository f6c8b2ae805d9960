# SPDX-License-Identifier: GPL-3.0-or-later

"""File names: characters that each system allows, and paths that lead to the same file."""

import ntpath
import os
import re
import unicodedata
from collections.abc import Hashable
from contextlib import suppress
from pathlib import PurePath

_FORBIDDEN = re.compile(r'[<>:"/\\|?*\x00-\x1f\x7f\ud800-\udfff]')
"""Characters that Windows forbids in names, and lone surrogates."""
_DEVICES = frozenset(
    ["con", "prn", "aux", "nul", "conin$", "conout$"]
    + [f"{device}{digit}" for device in ("com", "lpt") for digit in "0123456789¹²³"]
)
"""Device names of Windows, in lower case; reserved with any extension."""


def portable(name: str) -> str:
    """Returns a path component that is valid and reads the same on every system.

    Characters that Windows forbids and trailing dots and spaces become "_"; accented letters are
    composed (NFC); "_" is appended to Windows' device names.
    """
    composed = _FORBIDDEN.sub("_", unicodedata.normalize("NFC", name))
    bare = composed.rstrip(". ")
    composed = bare + "_" * (len(composed) - len(bare))
    stem, dot, extensions = composed.partition(".")
    return f"{stem}_{dot}{extensions}" if _is_device(stem) else composed


def check_windows_names(path: str, who: str = "", *, is_windows: bool = os.name == "nt") -> None:
    """Raises ValueError on Windows if a path to write is reserved or forbidden there.

    Args:
        path: The path as given.
        who: Prefix of the error message.
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
    """Returns keys that identify a file: two paths lead to the same file if they share a key.

    Symbolic links are followed; hard links, and names that differ only in case or in Unicode
    composition, count as one file.
    """
    name = unicodedata.normalize("NFC", os.path.realpath(path))
    keys: set[Hashable] = {unicodedata.normalize("NFC", name.casefold())}
    with suppress(OSError, ValueError):
        about = os.stat(path)
        if about.st_ino:
            keys.add((about.st_dev, about.st_ino))
    return keys


def stem_of(path: str) -> str:
    """Returns a file's name without folder and last extension, made `portable`."""
    return portable(PurePath(path).stem)


def _is_device(stem: str) -> bool:
    return stem.rstrip(" ").lower() in _DEVICES
