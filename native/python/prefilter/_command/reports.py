# SPDX-License-Identifier: GPL-3.0-or-later

"""What is kept of failures that nobody has foreseen, for those who mend them."""

import os
import sys

from . import streams

DEBUG = "PREFILTER_DEBUG"
"""The environment variable that has tracebacks printed, if it is not empty."""
_PAGE = "https://extensions.blender.org/add-ons/prefilter/"


def unexpected(error: BaseException) -> str:
    """Returns the line that asks for a report; the traceback is printed, or kept in a file."""
    kind, text = type(error).__name__, str(error)
    what = f"{kind}: {text[:200]}" if text else kind
    if os.environ.get(DEBUG):
        show(error)
        where = "the lines above"
    else:
        kept = _kept(error)
        where = f"the file '{kept}'" if kept else f"what it prints with {DEBUG}=1 set"
    return f"unexpected failure ({what}); please report it at {_PAGE} with {where}"


def show(error: BaseException) -> None:
    """Prints where an error comes from, where that is wanted."""
    if os.environ.get(DEBUG):
        streams.write(sys.stderr, _traceback(error), "")


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
