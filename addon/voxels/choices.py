# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings of voxels and booleans."""

from prefilter.options.voxels import (
    FACES,
    HOLES,
    INTERPOLANTS,
    OPERANDS,
    OPERATIONS,
    ORIGINALS,
    OUTPUTS,
    RESOLUTIONS,
    BooleanSettings,
    VoxelizeSettings,
    VoxelSettings,
)

__all__ = (
    "FACES",
    "HOLES",
    "INTERPOLANTS",
    "OPERANDS",
    "OPERATIONS",
    "ORIGINALS",
    "OUTPUTS",
    "RESOLUTIONS",
    "BooleanSettings",
    "VoxelSettings",
    "VoxelizeSettings",
)
