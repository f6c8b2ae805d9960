# SPDX-License-Identifier: GPL-3.0-or-later

"""Renders the tasks of a farm for a surface: shares of points, parts, and the whole.

usage: blender --background --python farm.py -- TARGET.png
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parent))
import scans
from scans import HUES, Floats, Mesh, Subject, View, demo

from bench.points import ply, sets
from bench.voxels.meshes import Triangles

DEPTH = 8
POINTS = 300_000
FILES, PARTS = 4, 8
GAP = 0.09
VIEW = View((-0.02, 0.0, 0.02), 3.0, -20, 4, dot=0.0019)


def main(target: Path) -> None:
    """Makes the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scans.set_up_render()
    cloud = sets.Model.of(Triangles(*scans.monkey())).draw(POINTS, np.random.default_rng(7))
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        share = shares(cloud[0])
        files = [work / f"{k}.ply" for k in range(FILES)]
        for k, file in enumerate(files):
            own = share == k
            ply.write_points(file, int(own.sum()), [(cloud[0][own], cloud[1][own])])
        whole, cell = made_in_steps(files, work)
        part = parts(whole, cell * 2**DEPTH)
        subjects = [
            Subject(
                "Count",
                f"{FILES} tasks, a share of the points each",
                lambda view: scans.add_points(*cloud, HUES[share], view.dot * view.width),
            ),
            Subject(
                "Part",
                f"{PARTS} tasks, some layers of the surface each",
                lambda _: add_parts(apart(whole, part), part),
            ),
            Subject(
                "Join",
                f"one surface, {len(whole[1]):,} triangles",
                lambda _: scans.add_surface(whole),
            ),
        ]
        (panels,) = scans.shots(subjects, [VIEW], work)
    demo.save(demo.comparison(panels), target)


def shares(points: Floats) -> np.ndarray:
    """Returns the scan number of each point, by the side it is on."""
    angle = np.arctan2(points[:, 1], points[:, 0] + 0.3)
    return np.floor((angle / (2 * np.pi) + 0.4) * FILES).astype(int) % FILES


def made_in_steps(files: list[Path], work: Path) -> tuple[Mesh, float]:
    """Returns the surface, made by a process per task, and the side of a cell."""
    target = work / "surface.ply"
    words = [sys.executable, "-m", "prefilter", "reconstruct", *map(str, files)]
    words += ["-o", str(target)]
    words += ["--depth", str(DEPTH), "--parts", str(PARTS), "--work", str(work / "steps")]
    search = ":".join([str(Path(prefilter.__file__).parents[1]), *sys.path])
    for step, tasks in {"measure": FILES, "count": FILES, "merge": 1, "part": PARTS}.items():
        for task in range(1, tasks + 1):
            flags = ["--step", step, "--task", f"{task}/{tasks}"]
            subprocess.run([*words, *flags], check=True, env={"PYTHONPATH": search})
    last = [*words, "--step", "join"]
    told = subprocess.check_output(last, text=True, env={"PYTHONPATH": search})
    cell = re.search(r"in cells of ([0-9.]+):", told)
    assert cell is not None
    read = ply.read_mesh(target)
    return (read.positions, read.triangles), float(cell[1])


def parts(mesh: Mesh, side: float) -> np.ndarray:
    """Returns the part of each triangle: parts have equally many layers of cells."""
    positions, triangles = mesh
    low, high = positions.min(axis=0), positions.max(axis=0)
    height = positions[triangles][..., 2].mean(axis=1) - (low[2] + high[2]) / 2
    return np.clip(np.floor((height / side + 0.5) * PARTS), 0, PARTS - 1).astype(int)


def apart(mesh: Mesh, part: np.ndarray) -> Mesh:
    """Returns a mesh with its parts moved apart."""
    positions, triangles = mesh
    corners = positions[triangles]
    corners[..., 2] += GAP * (part - (PARTS - 1) / 2)[:, None]
    return corners.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def add_parts(mesh: Mesh, part: np.ndarray) -> bpy.types.Object:
    """Adds a mesh with a color per part."""
    obj = scans.add_surface(mesh)
    obj.data.polygons.foreach_set("use_smooth", np.zeros(len(part), bool))
    clay = obj.data.materials[0]
    obj.data.materials.clear()
    for hue in HUES[:PARTS]:
        material = clay.copy()
        shader = material.node_tree.nodes["Principled BSDF"]
        linear = prefilter.to_linear(hue.astype(np.float32)[None, None])[0, 0]
        shader.inputs["Base Color"].default_value = (*linear.tolist(), 1)
        obj.data.materials.append(material)
    obj.data.polygons.foreach_set("material_index", part.astype(np.int32))
    return obj


if __name__ == "__main__":
    main(Path(sys.argv[sys.argv.index("--") + 1]))
