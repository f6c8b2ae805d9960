# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter filters images and shapes for the surfaces that use them.

Arrays are numpy or nested lists of real numbers; images and occupancies come out as float32,
positions as float64. Images have shape (height, width, channels) or (height, width), row 0 at v = 0
(the bottom row, as in Blender and OpenGL); uint8 and uint16 stand for a 255th and a 65535th. Bad
arguments raise ValueError, with a message that names the argument, what was found and what is
allowed.
"""

import re
from importlib import import_module
from pathlib import Path
from typing import Any

from . import _native

# Modules are imported when one of their names is first used: Blender imports the package at every
# start, and most sessions use little of it. The stub lists the names, each with its module.
_STUB = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
_HOME_OF = {name: home for home, name in re.findall(r"(?m)^from (\S+) import (\w+) as", _STUB)}

__version__ = _native.VERSION
__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOME_OF[name], __name__), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
