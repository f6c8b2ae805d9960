# SPDX-License-Identifier: GPL-3.0-or-later

"""Placement of results in Blender: they replace their sources, and remember them."""

from collections.abc import Sequence
from enum import Enum, auto

import bpy
import numpy as np

from ..bridge import kept_sources, new_meshes
from . import memory, places
from .choices import VoxelSettings
from .findings import Report
from .steps import Result


class Placement(Enum):
    """How a result replaces the object's mesh."""

    ALONE = auto()
    """The original is not kept."""
    KEEPING = auto()
    """The original is kept if the settings say so."""
    AGAIN = auto()
    """The result replaces an earlier one, and keeps its sources."""
    SCULPTED = auto()
    """The result replaces the sculpted mesh; the object keeps its recipe."""


def show(
    obj: bpy.types.Object,
    result: Result,
    settings: VoxelSettings,
    operands: Sequence[bpy.types.Object],
    report: Report,
    placement: Placement,
) -> bpy.types.Object:
    """Makes an object show a surface, or a new object in its stead; returns that object."""
    assert result.contour is not None
    assert result.topology is not None
    cell = result.grid.spacing * float(abs(np.linalg.det(result.frame.to_local)) ** (1.0 / 3.0))
    if placement == Placement.AGAIN:
        made = new_meshes.show_again(obj, result.contour)
        if made.prefilter_made_of.is_source_shown:
            kept_sources.show(made, bpy.context, source=False)
    else:
        keeps = placement == Placement.KEEPING and settings.originals == "keep"
        if placement == Placement.KEEPING and not keeps:
            kept_sources.forget(obj, bpy.context)
        made = new_meshes.show_contour(obj, result.contour, keeps_source=keeps)
    if placement == Placement.SCULPTED:
        made.prefilter_voxels.cell = cell
        made.prefilter_found.is_there = False
    else:
        places.keep(made, report, result.topology)
        memory.remember(made, settings, operands, cell)
    return made
