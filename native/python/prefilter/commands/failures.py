# SPDX-License-Identifier: GPL-3.0-or-later

"""Descriptions of failures, and tracebacks of unexpected ones for bug reports."""

import sys

from ..workflows.damage import DEBUG, is_debugging, is_own
from . import streams

_PAGE = "https://extensions.blender.org/add-ons/prefilter/"


def describe(error: BaseException) -> str:
    """Returns the line that says why work failed: a known reason, or a request to report it."""
    from ..workflows.outcome import reason

    is_of_system = isinstance(error, OSError) and error.strerror is not None
    if not (is_of_system or is_own(error) or isinstance(error, MemoryError)):
        return describe_unexpected(error)
    print_traceback(error)
    return reason(error)


def describe_unexpected(error: BaseException) -> str:
    """Returns the line that asks for a report; the traceback is printed, or saved in a file."""
    kind, text = type(error).__name__, str(error)
    what = f"{kind}: {text[:200]}" if text else kind
    if is_debugging():
        print_traceback(error)
        where = "the lines above"
    else:
        path = _save_traceback(error)
        where = f"the file '{path}'" if path else f"what it prints with {DEBUG}=1 set"
    return f"unexpected failure ({what}); please report it at {_PAGE} with {where}"


def print_traceback(error: BaseException) -> None:
    """Prints the traceback of an error, if debugging is on."""
    if is_debugging():
        streams.write(streams.errors(), _traceback(error), "")


def _save_traceback(error: BaseException) -> str:
    """Saves the traceback in a new file and returns its path; empty if that is impossible."""
    import tempfile

    try:
        with tempfile.NamedTemporaryFile(
            "w",
            encoding="utf-8",
            errors="backslashreplace",
            prefix="prefilter-error-",
            suffix=".txt",
            delete=False,
        ) as file:
            file.write(_traceback(error))
            return file.name
    except OSError:
        return ""


def _traceback(error: BaseException) -> str:
    import platform
    import traceback

    from .. import _native

    about = f"prefilter {_native.VERSION}, Python {sys.version}, {platform.platform()}\n"
    return about + "".join(traceback.format_exception(error))
