# SPDX-License-Identifier: GPL-3.0-or-later

"""Blender's voxel remesh, the operator: a mesh in memory to a mesh in memory.

Run inside of Blender, it does the work once and prints what `clock` does.
usage: blender --background --factory-startup --python voxel_remesh.py -- MESH.npz CELL
"""

import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any


class VoxelRemesh:
    """`bpy.ops.object.voxel_remesh` without what comes after the contour.

    Fixing poles, preserving the volume and transferring attributes are off.
    """

    def __init__(self, mesh: Path, cell: float, *, threads: int = 1) -> None:
        """`mesh` holds positions and triangles; `cell` is the voxel size."""
        self.name = "Blender voxel remesh"
        command = ["blender", "--background", "--factory-startup", "--python-exit-code", "1"]
        command += ["--threads", str(threads), "--python", __file__]
        self._command = pinned([*command, "--", str(mesh), repr(cell)], threads)

    @staticmethod
    def missing() -> str:
        """Returns what is needed and is not there; nothing where all is."""
        return "" if shutil.which("blender") else "blender on PATH"

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command)


def remesh(mesh: Path, cell: float) -> Callable[[], Any]:
    """Returns the work."""
    import bpy
    import numpy as np

    loaded = dict(np.load(mesh))
    positions, triangles = loaded["positions"], loaded["triangles"]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    made = bpy.data.meshes.new("Mesh")
    made.vertices.add(len(positions))
    made.vertices.foreach_set("co", positions.astype(np.float32).ravel())
    made.loops.add(triangles.size)
    made.loops.foreach_set("vertex_index", triangles.astype(np.int32).ravel())
    made.polygons.add(len(triangles))
    made.polygons.foreach_set("loop_start", np.arange(len(triangles), dtype=np.int32) * 3)
    made.update(calc_edges=True)
    obj = bpy.data.objects.new("Mesh", made)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    made.remesh_voxel_size = cell
    made.remesh_voxel_adaptivity = 0.0
    for option in ("fix_poles", "preserve_volume", "preserve_attributes"):
        setattr(made, f"use_remesh_{option}", False)
    bpy.context.view_layer.update()

    def work() -> Any:
        bpy.ops.object.voxel_remesh()
        return obj.data

    return work


if __package__:
    from . import Measurement
    from .clock import pinned, run_clocked
else:
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    from clock import clocked

    arguments = sys.argv[sys.argv.index("--") + 1 :]
    result = clocked(remesh(Path(arguments[0]), float(arguments[1])))
    print(len(result.polygons), "faces,", len(result.vertices), "vertices")
