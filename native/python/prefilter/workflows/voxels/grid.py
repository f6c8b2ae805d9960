# SPDX-License-Identifier: GPL-3.0-or-later

"""The grid of a voxelization, and its memory requirements."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import prefilter

from ...options.voxels import VoxelSettings
from ..memory import Memory, free_memory
from ..wording import amount

FloatArray = NDArray[np.float64]
Box = tuple[FloatArray, FloatArray]

_MARGIN = 2
"""Empty cells on each side; the surface next to the outermost cells needs them."""
_BYTES_PER_CELL = 320.0
"""Memory of a tree, its contour and its mesh, per finest cell on the surface."""
_CELLS_PER_AREA = 1.5
"""Mean number of unit cells that a surface of area 1 crosses: |n|_1 averaged over directions."""
_MOST_CORNERS = 2**31 - 1


@dataclass(frozen=True)
class Grid:
    """A cube with 2^depth cells along each axis.

    Attributes:
        low: The low corner.
        side: The length of a side.
        depth: How often it is halved.
    """

    low: FloatArray
    side: float
    depth: int

    @property
    def bounds(self) -> Box:
        """The low and the high corner."""
        return self.low, self.low + self.side

    @property
    def cells(self) -> int:
        """Cells along an axis."""
        return 1 << self.depth

    @property
    def spacing(self) -> float:
        """The side of a cell."""
        return self.side / self.cells


def choose_grid(box: Box, settings: VoxelSettings) -> Grid:
    """Returns the grid for the contents of a box.

    With a voxel size, cell borders are multiples of it, so that grids of the same size coincide.

    Raises:
        ValueError: The voxel size yields too many cells, or the box has no extent.
    """
    low, high = box
    extent = float((high - low).max())
    if not extent > 0.0:
        raise ValueError("all its vertices coincide")
    if settings.resolution == "depth":
        return _grid_of_depth(box, extent, settings.depth)
    size = settings.voxel_size
    needed = extent / size + 2 * _MARGIN + 1
    most = 1 << prefilter.MAX_DEPTH
    if needed > most:
        least = extent / (most - 2 * _MARGIN - 1)
        raise ValueError(
            f"Voxel Size: {size:g} would need {needed:.0f} cells per axis; the limit is "
            f"{most}. Use {least:.3g} or more"
        )
    depth = max(1, (math.ceil(needed) - 1).bit_length())
    side = size * (1 << depth)
    return Grid(np.floor(((low + high) / 2 - side / 2) / size + 0.5) * size, side, depth)


def cells_crossed(grid: Grid, area: float) -> float:
    """Estimates how many cells a surface of the given area crosses."""
    return min(_CELLS_PER_AREA * area / grid.spacing**2, float(grid.cells) ** 3)


def check_memory(grid: Grid, area: float, memory: Memory = free_memory) -> None:
    """Raises MemoryError if a surface in this grid would not fit into memory."""
    crossed = cells_crossed(grid, area)
    needed, (free, why) = _BYTES_PER_CELL * crossed, memory()
    if needed > free or 6 * crossed > _MOST_CORNERS:
        raise MemoryError(
            f"cells of {grid.spacing:.3g} need about {needed / 1e9:.3g} GB of memory, and "
            f"{amount(2 * crossed, 'triangle')}; {why}: use fewer or larger cells"
        )


def check_dense_memory(grid: Grid, memory: Memory = free_memory) -> None:
    """Raises MemoryError if a dense array of the cells would not fit into memory."""
    needed, (free, why) = 4.0 * float(grid.cells) ** 3, memory()
    if needed > free:
        raise MemoryError(
            f"a volume of {grid.cells}³ cells needs {needed / 1e9:.3g} GB of memory; {why}: use "
            f"fewer or larger cells"
        )


def _grid_of_depth(box: Box, extent: float, depth: int) -> Grid:
    low, high = prefilter.cube_around(box, depth=depth)
    return Grid(low, float((high - low).max()), depth)
