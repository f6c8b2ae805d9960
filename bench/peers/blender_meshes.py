# SPDX-License-Identifier: GPL-3.0-or-later

"""Blender's Remesh modifier and its EXACT boolean: meshes in files to a mesh in a file.

Run inside of Blender, it does every job of a list; see `run_jobs`.
usage: blender --background --factory-startup --python blender_meshes.py -- JOBS.json
"""

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

REMESH_MODES = ("SHARP", "SMOOTH", "VOXEL")


@dataclass(frozen=True)
class Job:
    """A modifier on a mesh.

    Attributes:
        sources: Files of positions and triangles; the boolean has two.
        target: The file that gets positions, triangles, and seconds; none where it failed.
        modifier: One of `REMESH_MODES`, or UNION, INTERSECT or DIFFERENCE.
        depth: The depth of the octree of SHARP and SMOOTH.
        scale: The largest side of the mesh, as a share of their octree's side.
        cell: The voxel size of VOXEL.
    """

    sources: tuple[str, ...]
    target: str
    modifier: str
    depth: int = 7
    scale: float = 0.9
    cell: float = 0.1


def missing() -> str:
    """Returns the missing requirement; empty if there is none."""
    return "" if shutil.which("blender") else "blender on PATH"


def run_jobs(jobs: Sequence[Job]) -> None:
    """Does them in one process of Blender.

    Raises:
        OSError: Blender failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "jobs.json"
        path.write_text(json.dumps([asdict(job) for job in jobs]))
        command = ["blender", "--background", "--factory-startup", "--python-exit-code", "1"]
        command += ["--python", __file__, "--", str(path)]
        made = subprocess.run(command, capture_output=True, text=True, check=False)
    if made.returncode != 0:
        raise OSError(f"Blender ended with status {made.returncode}: {made.stdout}{made.stderr}")


def _object(path: str) -> Any:
    import bpy
    import numpy as np

    loaded = dict(np.load(path))
    positions, triangles = loaded["positions"], loaded["triangles"]
    mesh = bpy.data.meshes.new("Mesh")
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.astype(np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(len(triangles), dtype=np.int32) * 3)
    mesh.update(calc_edges=True)
    made = bpy.data.objects.new("Mesh", mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def _do(job: dict[str, Any]) -> None:
    import time

    import bpy
    import numpy as np

    bpy.ops.wm.read_factory_settings(use_empty=True)
    objects = [_object(path) for path in job["sources"]]
    if job["modifier"] in REMESH_MODES:
        modifier = objects[0].modifiers.new("Remesh", "REMESH")
        modifier.mode = job["modifier"]
        if modifier.mode == "VOXEL":
            modifier.voxel_size = job["cell"]
        else:
            modifier.octree_depth, modifier.scale = job["depth"], job["scale"]
            modifier.use_remove_disconnected = False
    else:
        modifier = objects[0].modifiers.new("Boolean", "BOOLEAN")
        modifier.solver, modifier.operation = "EXACT", job["modifier"]
        modifier.object = objects[1]
    began = time.perf_counter()
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = objects[0].evaluated_get(graph).to_mesh()
    mesh.calc_loop_triangles()
    seconds = time.perf_counter() - began
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", positions)
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    np.savez(
        job["target"],
        positions=positions.reshape(-1, 3).astype(np.float64),
        triangles=triangles.reshape(-1, 3).astype(np.int64),
        seconds=seconds,
    )


if not __package__:
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    for listed in json.loads(Path(arguments[0]).read_text()):
        _do(listed)
