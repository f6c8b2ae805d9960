# SPDX-License-Identifier: GPL-3.0-or-later

"""Blender's own OpenImageIO module for Python, which the package uses, too.

Official Blender builds include it. A second copy of the library in Blender's process is a known
cause of crashes, so the add-on has none.
"""

from types import ModuleType

from prefilter.workflows.openimageio import (
    TILE_SIZE,
    Check,
    ValueKind,
    check_whole,
    color_convert,
    last_error,
    module,
    set_finder,
    value_kind,
    write_texture,
)

from . import own_modules

__all__ = (
    "TILE_SIZE",
    "Check",
    "ValueKind",
    "check_whole",
    "color_convert",
    "last_error",
    "module",
    "value_kind",
    "write_texture",
)


def _blenders_own() -> ModuleType:
    try:
        return own_modules.load("OpenImageIO")
    except ImportError as error:
        raise OSError(
            "this Blender has no OpenImageIO for Python. Official Blenders have it, and so has the "
            "module bpy since 4.4; on Debian and Ubuntu install python3-openimageio"
        ) from error


set_finder(_blenders_own)
