"""Prefilter: mipmaps that know the mesh, voxels of any mesh, surfaces of scans, in Blender."""

from importlib import import_module

from .commands import Commands
from .core import menus
from .core.registration import registration

SUBJECTS = (
    "mipmaps",
    "resampling",
    "scans",
    "voxels",
)
"""The folders of the subjects, in the order in which they are registered."""

_packages = [import_module(f".{name}", __package__) for name in SUBJECTS]
register, unregister = registration(menus, *_packages, Commands(SUBJECTS))
