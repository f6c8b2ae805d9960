# SPDX-License-Identifier: GPL-3.0-or-later

"""OpenVDB files and volume datablocks, by Blender's own Python module for OpenVDB."""

from functools import cache
from pathlib import Path
from types import ModuleType

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.translations import marked
from .. import own_modules

NEEDED = marked("This Blender has no Python module for OpenVDB (openvdb or pyopenvdb)")
_NAMES = ("openvdb", "pyopenvdb")
_GRID_NAME = "density"


def is_available() -> bool:
    """Whether this Blender can write OpenVDB files."""
    return _module() is not None


def write_grid(
    path: Path, occupancy: NDArray[np.float32], low: NDArray[np.float64], spacing: float
) -> None:
    """Writes a cube of cells as the density of a fog volume; empty cells are not stored.

    Args:
        path: The file.
        occupancy: (n, n, n), indexed [x, y, z].
        low: The low corner of cell (0, 0, 0).
        spacing: The side of a cell.

    Raises:
        OSError: There is no module, or the file cannot be written.
    """
    openvdb = _module()
    if openvdb is None:
        raise OSError(NEEDED)
    grid = openvdb.FloatGrid()
    grid.copyFromArray(occupancy)
    grid.name = _GRID_NAME
    grid.gridClass = openvdb.GridClass.FOG_VOLUME
    grid.transform = openvdb.createLinearTransform(
        [
            [spacing, 0.0, 0.0, 0.0],
            [0.0, spacing, 0.0, 0.0],
            [0.0, 0.0, spacing, 0.0],
            [*(float(corner) + spacing / 2 for corner in low), 1.0],
        ]
    )
    try:
        openvdb.write(str(path), [grid])
    except (RuntimeError, ValueError) as error:
        raise OSError(f"file '{path}': {error}") from error


def new_volume(name: str, path: Path) -> bpy.types.Volume:
    """Makes a volume datablock that shows a file."""
    volume = bpy.data.volumes.new(name)
    volume.filepath = bpy.path.relpath(str(path)) if bpy.data.is_saved else str(path)
    return volume


@cache
def _module() -> ModuleType | None:
    for name in _NAMES:
        try:
            return own_modules.load(name)
        except ImportError:
            continue
    return None
