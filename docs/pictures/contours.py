# SPDX-License-Identifier: GPL-3.0-or-later

"""Renders one octree's surface by each interpolant, in a mirror finish (figures 3.5 and 5.6).

The solid is a ball in a ring; its box has 64 cells along an axis.

usage: blender --background --python contours.py -- TARGET.png
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import demo_scene as demo

DEPTH = 6
SAMPLES = 64
STRIPES = 7.0
PANELS = (
    ("linear", "Linear", "marching cubes"),
    ("occupancy", "Occupancy", "section 5.2"),
    ("plane", "Plane", "sums of columns"),
)


def main(target: Path) -> None:
    """Makes the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bounds = (np.full(3, -1.1), np.full(3, 1.1))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=0.55)
    ball = triangles_of(bpy.context.object)
    bpy.ops.mesh.primitive_torus_add(
        major_segments=256,
        minor_segments=96,
        major_radius=0.85,
        minor_radius=0.2,
        rotation=(0.45, 0.25, 0.0),
    )
    ring = triangles_of(bpy.context.object)
    octree = prefilter.voxelize(*ball, depth=DEPTH, bounds=bounds)
    octree = octree.union(prefilter.voxelize(*ring, depth=DEPTH, bounds=bounds))

    demo.set_up_render()
    set_up_stripes(bpy.context.scene)
    panels = []
    with tempfile.TemporaryDirectory() as name:
        for interpolant, title, note in PANELS:
            obj = add_surface(*octree.contour(interpolant=interpolant, cleanup=True))
            print(f"{interpolant}: {len(obj.data.polygons)} triangles")
            panels.append((title, note, demo.render(Path(name))))
            bpy.data.objects.remove(obj)
    demo.save(demo.comparison(panels), target)


def triangles_of(obj: bpy.types.Object) -> tuple[np.ndarray, np.ndarray]:
    """Returns positions in the world and triangles, and removes the object."""
    bpy.context.view_layer.update()
    mesh = obj.data
    mesh.calc_loop_triangles()
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    triangles = np.empty((len(mesh.loop_triangles), 3), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles.ravel())
    matrix = np.array(obj.matrix_world)
    bpy.data.objects.remove(obj)
    return positions @ matrix[:3, :3].T + matrix[:3, 3], triangles


def add_surface(positions: np.ndarray, triangles: np.ndarray) -> bpy.types.Object:
    """Adds a smooth mesh that is a mirror."""
    mesh = bpy.data.meshes.new("Surface")
    mesh.from_pydata(positions.tolist(), [], triangles.tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    material = bpy.data.materials.new("Mirror")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Metallic"].default_value = 1.0
    shader.inputs["Roughness"].default_value = 0.0
    shader.inputs["Base Color"].default_value = (0.9, 0.9, 0.9, 1.0)
    mesh.materials.append(material)
    obj = bpy.data.objects.new("Surface", mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def set_up_stripes(scene: bpy.types.Scene) -> None:
    """Surrounds the scene with stripes, which the mirror reflects; no other light."""
    for obj in list(scene.objects):
        if obj.type == "LIGHT":
            bpy.data.objects.remove(obj)
    scene.camera.data.ortho_scale = 2.6
    scene.camera.location.x -= 0.2
    scene.cycles.samples = SAMPLES
    scene.cycles.max_bounces = 3
    tree = scene.world.node_tree
    nodes, links = tree.nodes, tree.links
    coordinates = nodes.new("ShaderNodeTexCoord")
    wave = nodes.new("ShaderNodeTexWave")
    wave.wave_profile = "SIN"
    wave.bands_direction = "Z"
    wave.inputs["Scale"].default_value = STRIPES / 6.2832
    ramp = nodes.new("ShaderNodeValToRGB")
    low, high = ramp.color_ramp.elements
    low.position, low.color = 0.44, (0.02, 0.035, 0.06, 1)
    high.position, high.color = 0.56, (0.95, 0.95, 0.92, 1)
    links.new(coordinates.outputs["Generated"], wave.inputs["Vector"])
    links.new(wave.outputs["Fac"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Background"].inputs["Color"])
    nodes["Background"].inputs["Strength"].default_value = 1.0


main(Path(sys.argv[sys.argv.index("--") + 1]))
