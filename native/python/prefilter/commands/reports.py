# SPDX-License-Identifier: GPL-3.0-or-later

"""What is kept of failures that nobody has foreseen, for those who mend them."""

import sys

from ..workflows.damage import DEBUG, is_debugging, is_own
from . import streams

_PAGE = "https://extensions.blender.org/add-ons/prefilter/"


def told(error: BaseException) -> str:
    """Returns the line that says why work failed: our own reason, or that nobody foresaw it."""
    from ..workflows.outcome import reason

    is_of_system = isinstance(error, OSError) and error.strerror is not None
    if not (is_of_system or is_own(error) or isinstance(error, MemoryError)):
        return unexpected(error)
    show(error)
    return reason(error)


def unexpected(error: BaseException) -> str:
    """Returns the line that asks for a report; the traceback is printed, or kept in a file."""
    kind, text = type(error).__name__, str(error)
    what = f"{kind}: {text[:200]}" if text else kind
    if is_debugging():
        show(error)
        where = "the lines above"
    else:
        kept = _kept(error)
        where = f"the file '{kept}'" if kept else f"what it prints with {DEBUG}=1 set"
    return f"unexpected failure ({what}); please report it at {_PAGE} with {where}"


def show(error: BaseException) -> None:
    """Prints where an error comes from, where that is wanted."""
    if is_debugging():
        streams.write(streams.errors(), _traceback(error), "")


def _kept(error: BaseException) -> str:
    """Returns the new file that has the traceback; empty where there can be none."""
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
