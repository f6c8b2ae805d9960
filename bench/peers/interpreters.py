# SPDX-License-Identifier: GPL-3.0-or-later

"""Python interpreters with modules that ours lacks."""

import functools
import os
import subprocess
import sys


def interpreter(variable: str) -> str:
    """Returns the Python that an environment variable names; ours where it is not set."""
    return os.environ.get(variable) or sys.executable


@functools.cache
def can_import(variable: str, module: str) -> bool:
    """Returns whether that Python has a module."""
    try:
        command = [interpreter(variable), "-c", f"import {module}"]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False
