# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter for Blender: mipmaps fitted to meshes, voxels, surfaces of scans, vector shapes."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module

SUBJECTS = (
    "welcome",
    "textures",
    "texture_cache",
    "images",
    "points",
    "shapes",
    "voxels",
    "comparison",
)
"""The folders of the subjects, in the order of registration."""


@contextmanager
def _collector_paused() -> Iterator[None]:
    """Disables Python's garbage collector, which takes a third of the loading time.

    Loading modules creates many objects and no garbage.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


with _collector_paused():
    from .commands import Commands
    from .core import (
        menus,
        preset_menu,
        queue_panel,
        runs,
        scene_cache,
        shortcuts,
        sidebar,
        translations,
    )
    from .core.keys import Keys
    from .core.registration import registration
    from .manual import Manual
    from .preferences import SubjectPreferences
    from .textures.gltf.hooks import (
        glTF2_pre_export_callback,
        glTF2ExportUserExtension,
        glTF2ImportUserExtension,
    )
    from .textures.gltf.panel import draw_export, draw_import

    _packages = [import_module(f".{name}", __package__) for name in SUBJECTS]

__all__ = (
    "draw_export",
    "draw_import",
    "glTF2ExportUserExtension",
    "glTF2ImportUserExtension",
    "glTF2_pre_export_callback",
)
# Blender's glTF exporter and importer look up these names.

register, unregister = registration(
    translations,
    *(SubjectPreferences(_packages), preset_menu, runs, scene_cache, menus, sidebar, queue_panel),
    shortcuts,
    *_packages,
    *(Commands(SUBJECTS), Manual(_packages), Keys(_packages)),
)
