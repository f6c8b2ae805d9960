# SPDX-License-Identifier: GPL-3.0-or-later

"""Results into Blender: in the place of what they were made of, which they remember."""

from collections.abc import Sequence
from enum import Enum, auto

import bpy
import numpy as np

from ..bridge import kept_sources, new_meshes
from . import memory, places
from .choices import VoxelSettings
from .findings import Report
from .steps import Result


class Way(Enum):
    """How a result takes its place."""

    ALONE = auto()
    """Nothing is kept of what was there."""
    KEEPING = auto()
    """With what was there, if the settings say so."""
    AGAIN = auto()
    """In place of an earlier result, which keeps what it was made of."""
    SCULPTED = auto()
    """In place of what is sculpted; how that was made stays as it was."""


def show(
    obj: bpy.types.Object,
    result: Result,
    settings: VoxelSettings,
    operands: Sequence[bpy.types.Object],
    report: Report,
    way: Way,
) -> bpy.types.Object:
    """Has an object show a surface, and returns the object that does."""
    assert result.contour is not None
    assert result.topology is not None
    cell = result.grid.spacing * float(abs(np.linalg.det(result.place.to_local)) ** (1.0 / 3.0))
    if way == Way.AGAIN:
        made = new_meshes.show_again(obj, result.contour)
        if made.prefilter_made_of.is_source_shown:
            kept_sources.show(made, bpy.context, source=False)
    else:
        keeps = way == Way.KEEPING and settings.originals == "keep"
        if way == Way.KEEPING and not keeps:
            kept_sources.forget(obj, bpy.context)
        made = new_meshes.show_contour(obj, result.contour, keeps_source=keeps)
    if way == Way.SCULPTED:
        made.prefilter_voxels.cell = cell
        made.prefilter_found.is_there = False
    else:
        places.keep(made, report, result.topology)
        memory.remember(made, settings, operands, cell)
    return made
