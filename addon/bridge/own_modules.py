# SPDX-License-Identifier: GPL-3.0-or-later

"""Python modules that are part of Blender.

The application finds them by itself. An official build as a Python module, `bpy`, has them in a
folder that Python does not search, and another installed copy may be incompatible with the
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
    """Loads Blender's own module, or else an installed one.

    Raises:
        ImportError: There is no such module, or it cannot be loaded.
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
    """Folder of modules of an official build; it may not exist."""
    library = Path(bpy.utils.resource_path("LOCAL"), "python", "lib")
    if os.name != "nt":
        library /= f"python{sys.version_info.major}.{sys.version_info.minor}"
    return library / "site-packages"
