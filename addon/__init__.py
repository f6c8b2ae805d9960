"""Prefilter: mipmaps that know the mesh, and voxels of any mesh, in Blender."""

from . import commands, operators, panels, settings, view, voxel_settings

_PARTS = (settings, voxel_settings, view, operators, panels, commands)


def register() -> None:
    """Registers every part of the add-on."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Unregisters every part of the add-on, in reverse."""
    for part in reversed(_PARTS):
        part.unregister()
