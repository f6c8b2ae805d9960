# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter: mipmaps that know the mesh, voxels, surfaces of scans, vector shapes, in Blender."""

from importlib import import_module

from . import preferences
from .commands import Commands
from .core import menus, presets, running
from .core.registration import registration

SUBJECTS = (
    "mipmaps",
    "resampling",
    "scans",
    "shapes",
    "voxels",
)
"""The folders of the subjects, in the order in which they are registered."""

_packages = [import_module(f".{name}", __package__) for name in SUBJECTS]
register, unregister = registration(
    preferences, presets, running, menus, *_packages, Commands(SUBJECTS)
)
