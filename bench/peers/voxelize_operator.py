# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter's operator at its defaults: an object in Blender to an object in Blender.

Run inside of Blender, it does the work once and prints what `clock` does.
usage: blender --background --python voxelize_operator.py -- MESH.npz DEPTH
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any


class VoxelizeOperator:
    """`bpy.ops.prefilter.voxelize`: solid, cells, sharp contour, clean-up, mesh."""

    def __init__(self, mesh: Path, depth: int, *, threads: int = 1) -> None:
        """`mesh` holds positions and triangles."""
        self.name = "prefilter voxelize"
        command = ["blender", "--background", "--python-exit-code", "1"]
        command += ["--threads", str(threads), "--python", __file__]
        self._command = pinned([*command, "--", str(mesh), str(depth)], threads)

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command)


def voxelization(mesh: Path, depth: int) -> Callable[[], Any]:
    """Returns the work."""
    import bpy

    new_object(mesh)

    def work() -> Any:
        if bpy.ops.prefilter.voxelize(depth=depth) != {"FINISHED"}:
            raise RuntimeError("voxelize did not finish")
        return bpy.context.view_layer.objects.active.data

    return work


if __package__:
    from . import Measurement
    from .clock import pinned, run_clocked
else:
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    from clock import clocked
    from voxel_remesh import new_object

    arguments = sys.argv[sys.argv.index("--") + 1 :]
    result = clocked(voxelization(Path(arguments[0]), int(arguments[1])))
    print(len(result.polygons), "faces,", len(result.vertices), "vertices")
