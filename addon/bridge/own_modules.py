# SPDX-License-Identifier: GPL-3.0-or-later

"""Python modules that Blender brings along, wherever it keeps them.

The application finds them by itself. An official build that is a module of Python, `bpy`, has them
in a folder that is not searched; and another copy that is installed beside it may not meet the
libraries that Blender has loaded.
"""

import importlib
import os
import sys
import threading
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path
from types import ModuleType

import bpy

_LOCK = threading.Lock()


def load(name: str) -> ModuleType:
    """Returns a module: Blender's own where it has one, else what is installed.

    Raises:
        ImportError: There is none, or it cannot be loaded.
    """
    with _LOCK:
        if name not in sys.modules:
            spec = PathFinder.find_spec(name, [str(_folder())])
            if spec is not None and spec.loader is not None:
                module = sys.modules[name] = module_from_spec(spec)
                try:
                    spec.loader.exec_module(module)
                except BaseException:
                    del sys.modules[name]
                    raise
        return importlib.import_module(name)


def _folder() -> Path:
    """Returns where an official build has its modules; a folder that may not exist."""
    library = Path(bpy.utils.resource_path("LOCAL"), "python", "lib")
    if os.name != "nt":
        library /= f"python{sys.version_info.major}.{sys.version_info.minor}"
    return library / "site-packages"
