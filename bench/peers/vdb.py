# SPDX-License-Identifier: GPL-3.0-or-later

"""OpenVDB's meshToVolume, through its Python module: a mesh in memory to a level set in memory.

Run as a program, it does the work once and prints what `clock` does.
usage: vdb.py MESH.npz CELL
"""

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any


class OpenVdb:
    """`createLevelSetFromPolygons` with its defaults: a band of three voxels to either side."""

    def __init__(self, mesh: Path, cell: float, *, threads: int = 1) -> None:
        """`mesh` holds positions and triangles; `cell` is the side of a voxel."""
        self.name = "OpenVDB meshToVolume"
        command = [sys.executable, __file__, str(mesh), repr(cell)]
        self._command = pinned(command, threads)

    @staticmethod
    def missing() -> str:
        """Returns the missing requirement; empty if there is none."""
        if module() is not None:
            return ""
        return "OpenVDB's Python module; Debian has it as python3-openvdb"

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command)


def module() -> Any:
    """Returns OpenVDB's module, None where there is none."""
    for name in ("openvdb", "pyopenvdb"):
        try:
            return importlib.import_module(name)
        except ImportError:
            continue
    return None


def level_set(mesh: Path, cell: float) -> Callable[[], Any]:
    """Returns the work."""
    import numpy as np

    vdb = module()
    loaded = dict(np.load(mesh))
    points = loaded["positions"].astype(np.float32)
    triangles = loaded["triangles"].astype(np.uint32)
    transform = vdb.createLinearTransform(voxelSize=cell)

    def work() -> Any:
        return vdb.FloatGrid.createLevelSetFromPolygons(
            points, triangles=triangles, transform=transform
        )

    return work


if __package__:
    from . import Measurement
    from .clock import pinned, run_clocked
else:
    from clock import clocked

    grid = clocked(level_set(Path(sys.argv[1]), float(sys.argv[2])))
    print(grid.activeVoxelCount(), "active voxels,", grid.memUsage() / 2**20, "MiB")
