"""Prefilter: mipmaps that know the mesh, and voxels of any mesh, in Blender."""

from . import mipmaps, voxels
from .commands import Commands
from .core.registration import registration

SUBJECTS = (mipmaps, voxels)

register, unregister = registration(*SUBJECTS, Commands(SUBJECTS))
