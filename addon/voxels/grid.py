# SPDX-License-Identifier: GPL-3.0-or-later

"""Grids of cells, and checks of their memory against the memory that Blender may use."""

from functools import partial

from prefilter.workflows.voxels import grid
from prefilter.workflows.voxels.grid import Box, Grid, cells_crossed, choose_grid

from ..core.memory import usable_memory

__all__ = (
    "Box",
    "Grid",
    "cells_crossed",
    "check_dense_memory",
    "check_memory",
    "choose_grid",
)

check_memory = partial(grid.check_memory, memory=usable_memory)
check_dense_memory = partial(grid.check_dense_memory, memory=usable_memory)
