# SPDX-License-Identifier: GPL-3.0-or-later

"""Explanations of unreadable files in our own words, and the origin of errors."""

import os
from contextlib import suppress
from json import JSONDecodeError

DEBUG = "PREFILTER_DEBUG"
"""Environment variable: if not empty, tracebacks and messages of libraries are printed."""
_OF_ENCODINGS = ("charset_normalizer", "chardet")
"""Packages that libraries import to read text that is not UTF-8."""
_EMPTY = "it is empty"
_DAMAGED = "it is damaged, or not what its extension says"


def is_debugging() -> bool:
    """Tells whether debugging output is on."""
    return bool(os.environ.get(DEBUG))


def damaged(path: str | os.PathLike[str], detail: str) -> str:
    """Returns the reason why a library cannot read a file.

    Args:
        path: The file.
        detail: The library's own message, shown when debugging.
    """
    reason = _DAMAGED
    with suppress(OSError):
        if os.path.getsize(path) == 0:
            reason = _EMPTY
    return f"{reason} ({' '.join(detail.split())})" if is_debugging() else reason


def why_unreadable(error: BaseException, path: str | os.PathLike[str]) -> str:
    """Returns why a library could not read a file; Prefilter's own messages stay as they are."""
    if isinstance(error, OSError) and error.strerror:
        other = error.filename
        is_other = other is not None and os.path.basename(os.fsdecode(other)) != os.path.basename(
            path
        )
        return f"{error.strerror}: '{os.fsdecode(other)}'" if is_other else error.strerror
    if os.path.isfile(path) and os.path.getsize(path) == 0:
        return _EMPTY
    if is_own(error):
        return " ".join(str(error).split())
    if isinstance(error, MemoryError):
        return "it takes more memory than there is"
    if isinstance(error, ImportError) and error.name in _OF_ENCODINGS:
        return "it is damaged, or has letters that are not in UTF-8"
    if isinstance(error, ImportError):
        return f"the Python package {error.name or 'that reads it'} is missing"
    if isinstance(error, JSONDecodeError) and error.doc.strip():
        return f"it is damaged: no JSON from line {error.lineno}, column {error.colno} on"
    return damaged(path, f"{type(error).__name__}: {error}")


def is_own(error: BaseException) -> bool:
    """Tells whether Prefilter itself raised an error, with its own reason."""
    if not isinstance(error, ValueError | OSError | MemoryError) or isinstance(error, UnicodeError):
        return False
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    module = trace.tb_frame.f_globals.get("__name__", "") if trace is not None else ""
    return "prefilter" in module.split(".")


def check_ply(path: str | os.PathLike[str]) -> None:
    """Raises ValueError if a PLY file is damaged or has no mesh."""
    from .. import _native

    _native.read_ply_mesh(os.fsencode(path), None)
