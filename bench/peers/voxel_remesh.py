# SPDX-License-Identifier: GPL-3.0-or-later

"""Blender's voxel remesh, the operator: a mesh in memory to a mesh in memory.

Run inside of Blender, it does the work once and prints what `clock` does.
usage: blender --background --factory-startup --python voxel_remesh.py -- MESH.npz CELL [whole]
       [RESULT.npz]

`suzanne.npz` without a file of this name is Blender's own Suzanne, subdivided, with its UV map.
"""

import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any


class VoxelRemesh:
    """`bpy.ops.object.voxel_remesh`, as a whole or only up to the contour.

    Only up to the contour, fixing poles, preserving the volume and transferring attributes are off;
    otherwise they have Blender's defaults.
    """

    def __init__(
        self, mesh: Path, cell: float, *, is_whole: bool = False, threads: int = 1
    ) -> None:
        """`mesh` holds positions and triangles; `cell` is the voxel size."""
        self.name = "Blender voxel remesh"
        command = ["blender", "--background", "--factory-startup", "--python-exit-code", "1"]
        command += ["--threads", str(threads), "--python", __file__]
        steps = ["whole"] if is_whole else []
        self._command = pinned([*command, "--", str(mesh), repr(cell), *steps], threads)

    @staticmethod
    def missing() -> str:
        """Returns the missing requirement; empty if there is none."""
        return "" if shutil.which("blender") else "blender on PATH"

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command)

    def made(self, result: Path) -> None:
        """Does the work once, and writes positions and quads with their source."""
        run([*self._command, str(result)])


def write(mesh: Any, result: Path, **more: Any) -> None:
    """Writes positions and faces of one size to a file, and arrays besides these."""
    import numpy as np

    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    faces = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", faces)
    np.savez(result, positions=positions, faces=faces.reshape(len(mesh.polygons), -1), **more)


def triangulated(obj: Any) -> dict[str, Any]:
    """Returns the triangulation of an object's mesh."""
    import numpy as np

    mesh = obj.data
    mesh.calc_loop_triangles()
    source = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", source.ravel())
    triangles = np.empty((len(mesh.loop_triangles), 3), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles.ravel())
    return {"source": source, "triangles": triangles}


def new_object(mesh: Path) -> Any:
    """Returns an object of the mesh, the only one that is selected, and active."""
    import bpy
    import numpy as np

    if not mesh.exists():
        return _suzanne()
    loaded = dict(np.load(mesh))
    positions, triangles = loaded["positions"], loaded["triangles"]
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
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj
    return obj


def _suzanne() -> Any:
    import bpy

    for obj in list(bpy.context.scene.objects):
        bpy.data.objects.remove(obj)
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.view_layer.objects.active
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 3
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    return obj


def remesh(obj: Any, cell: float, *, is_whole: bool) -> Callable[[], Any]:
    """Returns the work."""
    import bpy

    obj.data.remesh_voxel_size = cell
    obj.data.remesh_voxel_adaptivity = 0.0
    for option in () if is_whole else ("fix_poles", "preserve_volume", "preserve_attributes"):
        setattr(obj.data, f"use_remesh_{option}", False)
    bpy.context.view_layer.update()

    def work() -> Any:
        bpy.ops.object.voxel_remesh()
        return obj.data

    return work


if __package__:
    from . import Measurement, run
    from .clock import pinned, run_clocked
elif __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    import bpy
    from clock import clocked

    arguments = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    chosen = new_object(Path(arguments[0]))
    source = triangulated(chosen) if arguments[-1].endswith(".npz") else {}
    result = clocked(remesh(chosen, float(arguments[1]), is_whole="whole" in arguments[2:]))
    print(len(result.polygons), "faces,", len(result.vertices), "vertices")
    if source:
        write(result, Path(arguments[-1]), **source)
