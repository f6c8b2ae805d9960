# SPDX-License-Identifier: GPL-3.0-or-later

"""What a user may set for voxels and booleans."""

from dataclasses import dataclass

from prefilter._options.voxels import (
    FACES,
    HOLES,
    INTERPOLANTS,
    ORIGINALS,
    OUTPUTS,
    RESOLUTIONS,
    VoxelizeSettings,
    VoxelSettings,
)

from ..core.choices import Choice
from ..core.options import one_of, switch

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

OPERATIONS = {
    "difference": Choice("Difference", "Subtract the others from the active object"),
    "union": Choice("Union", "Keep what lies in any of the objects"),
    "intersection": Choice("Intersection", "Keep what lies in all of the objects"),
}
OPERANDS = {
    "keep": Choice("Keep", "The other objects stay as they are"),
    "hide": Choice("Hide", "The other objects are hidden, in renders too"),
    "delete": Choice("Delete", "The other objects are deleted"),
}


@dataclass(frozen=True)
class BooleanSettings(VoxelSettings):
    """What `prefilter.boolean` does."""

    operation: str = one_of(
        "difference", "Operation", "How to combine the objects", OPERATIONS, metavar="OPERATION"
    )
    operands: str = one_of(
        "hide", "Others", "What to do with the other selected objects", OPERANDS, flag=""
    )
    use_keep_resolution: bool = switch(
        True,
        "Keep Resolution",
        "Use cells as large as those of the active object, if an earlier run has made it",
        flag_description="use cells as large as those of the first operand, if an earlier run has "
        "made it and no resolution is given",
    )
