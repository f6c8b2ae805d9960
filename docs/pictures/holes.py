# SPDX-License-Identifier: GPL-3.0-or-later

"""Renders a ball with a hole, and voxelized after each method of close_holes.

usage: blender --background --python holes.py -- TARGET.png
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import demo_scene as demo

DEPTH = 8
SAMPLES = 48
PANELS = (
    ("", "Open", "before"),
    ("fan", "Fan", ""),
    ("flat", "Flat", ""),
    ("smooth", "Smooth", "the default"),
)


def main(target: Path) -> None:
    """Makes the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    positions, triangles = open_ball()
    demo.set_up_render()
    bpy.context.scene.cycles.samples = SAMPLES
    panels = []
    with tempfile.TemporaryDirectory() as name:
        for method, title, note in PANELS:
            mesh = (positions, triangles)
            if method:
                closed = prefilter.close_holes(positions, triangles, method=method)
                octree = prefilter.voxelize(closed.positions, closed.triangles, depth=DEPTH)
                mesh = octree.contour(interpolant="plane")
            obj = add_surface(*mesh)
            panels.append((title, note, demo.render(Path(name))))
            bpy.data.objects.remove(obj)
    demo.save(demo.comparison(panels), target)


def open_ball() -> tuple[np.ndarray, np.ndarray]:
    """Returns an uneven ball without a patch of its front."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=0.95)
    obj = bpy.context.object
    mesh = obj.data
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    triangles = np.empty((len(mesh.polygons), 3), np.int32)
    mesh.polygons.foreach_get("vertices", triangles.ravel())
    bpy.data.objects.remove(obj)
    positions = positions.astype(float)
    waves = 1 + 0.06 * np.sin(4 * positions[:, 2]) * np.cos(3 * positions[:, 0])
    positions *= waves[:, None] * (0.9, 0.9, 1.05)
    middles = positions[triangles].mean(axis=1)
    away = np.linalg.norm(middles - (0.15, -0.8, 0.35), axis=1)
    angle = np.arctan2(middles[:, 2] - 0.35, middles[:, 0] - 0.15)
    return positions, triangles[away > 0.5 + 0.06 * np.sin(5 * angle)]


def add_surface(positions: np.ndarray, triangles: np.ndarray) -> bpy.types.Object:
    """Adds a smooth mesh of clay."""
    mesh = bpy.data.meshes.new("Surface")
    mesh.from_pydata(positions.tolist(), [], triangles.tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    obj = bpy.data.objects.new("Surface", mesh)
    bpy.context.scene.collection.objects.link(obj)
    material = bpy.data.materials.new("Clay")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.55, 0.42, 0.33, 1)
    shader.inputs["Roughness"].default_value = 0.45
    mesh.materials.append(material)
    return obj


if __name__ == "__main__":
    main(Path(sys.argv[sys.argv.index("--") + 1]))
