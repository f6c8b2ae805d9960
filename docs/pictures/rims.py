# SPDX-License-Identifier: GPL-3.0-or-later

"""Renders the same boolean by four programs, whole and close to its rim.

A block that is turned against the axes, less a slanted cylinder: by Blender's EXACT solver, that
remeshed by Blender's Remesh in Sharp mode, and by octrees with their surface by occupancies alone
and with the edges of the operands. All but the first have 64 cells along an axis.

usage: blender --background --python rims.py -- TARGET.png
"""

import math
import sys
import tempfile
from pathlib import Path

import bpy
import mathutils
import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import demo_scene as demo

DEPTH = 6
SAMPLES = 24
RADIUS = 0.42
CREASE = math.radians(30)
TOWARD = mathutils.Vector((0.25, -0.55, 1.0)).normalized()
WHOLE, CLOSE = 2.6, 0.5  # Widths of the camera's view.
Mesh = tuple[np.ndarray, np.ndarray]


def main(target: Path) -> None:
    """Makes the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    block, cutter = operands()
    exact = modified(block, "BOOLEAN", {"solver": "EXACT", "object": cutter})
    scale = 1 - 4 / 2**DEPTH
    options = {"mode": "SHARP", "octree_depth": DEPTH, "scale": scale}
    remeshed = modified(object_of(exact), "REMESH", options)
    sources = [arrays_of(obj) for obj in (block, cutter)]
    points = sources[0][0]
    half = np.ptp(points, axis=0).max() / 2 / scale
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    bounds = (middle - half, middle + half)
    trees = [prefilter.voxelize(*mesh, depth=DEPTH, bounds=bounds) for mesh in sources]
    octree = trees[0].difference(trees[1])
    surfaces = {
        ("Blender EXACT", "no remesh"): exact,
        ("Blender Remesh", "Sharp, of EXACT's result"): remeshed,
        ("Occupancy", "no edges"): octree.contour(interpolant="occupancy"),
        ("Sharp", "edges of the operands"): octree.contour(interpolant="sharp", sources=sources),
    }
    for obj in list(bpy.context.scene.objects):
        bpy.data.objects.remove(obj)
    rim = rim_point(exact[0], sources[1])
    demo.set_up_render()
    set_up_light(bpy.context.scene)
    rows: list[list[np.ndarray]] = [[], []]
    with tempfile.TemporaryDirectory() as folder:
        for mesh in surfaces.values():
            obj = object_of(mesh)
            for row, view in zip(rows, (((0.0, 0.0, 0.0), WHOLE), (rim, CLOSE)), strict=True):
                aim(bpy.context.scene, *view)
                row.append(demo.render(Path(folder)))
            bpy.data.objects.remove(obj)
    demo.save(page(list(surfaces), rows), target)


def operands() -> tuple[bpy.types.Object, bpy.types.Object]:
    """The block and the cutting object."""
    bpy.ops.mesh.primitive_cube_add(size=1.5, rotation=(0.21, 0.33, 0.47))
    block = bpy.context.object
    bpy.ops.mesh.primitive_cylinder_add(
        vertices=256, radius=RADIUS, depth=4, rotation=(0.25, 0.2, 0.0)
    )
    cutter = bpy.context.object
    for obj in (block, cutter):
        obj.select_set(True)
    bpy.ops.object.transform_apply()
    return block, cutter


def modified(obj: bpy.types.Object, kind: str, options: dict[str, object]) -> Mesh:
    """The object after a modifier."""
    modifier = obj.modifiers.new(kind, kind)
    for name, value in options.items():
        setattr(modifier, name, value)
    mesh = arrays_of(obj)
    obj.modifiers.remove(modifier)
    return mesh


def arrays_of(obj: bpy.types.Object) -> Mesh:
    """Positions and triangles, with the modifiers."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    mesh.calc_loop_triangles()
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    triangles = np.empty((len(mesh.loop_triangles), 3), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles.ravel())
    return positions.astype(np.float64), triangles


def object_of(mesh: Mesh) -> bpy.types.Object:
    """An object of satin metal, smooth except at edges of more than 30 degrees."""
    made = bpy.data.meshes.new("Surface")
    made.from_pydata(mesh[0].tolist(), [], mesh[1].tolist())
    made.polygons.foreach_set("use_smooth", np.ones(len(made.polygons), bool))
    made.set_sharp_from_angle(angle=CREASE)
    material = bpy.data.materials.new("Metal")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Metallic"].default_value = 0.85
    shader.inputs["Roughness"].default_value = 0.32
    shader.inputs["Base Color"].default_value = (0.55, 0.6, 0.66, 1.0)
    made.materials.append(material)
    obj = bpy.data.objects.new("Surface", made)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def rim_point(positions: np.ndarray, cutter: Mesh) -> tuple[float, ...]:
    """The vertex of the cut that is nearest to the camera."""
    middle = cutter[0].mean(axis=0)
    axis = np.linalg.svd(cutter[0] - middle, full_matrices=False)[2][0]
    away = positions - middle
    radius = np.linalg.norm(away - np.outer(away @ axis, axis), axis=1)
    rim = positions[np.abs(radius - RADIUS) < 1e-3]
    return tuple(rim[(rim @ np.array(TOWARD)).argmax()])


def set_up_light(scene: bpy.types.Scene) -> None:
    """A sun, and a sky that is brighter above, so that edges stand out."""
    scene.cycles.samples = SAMPLES
    scene.cycles.max_bounces = 1
    for obj in scene.objects:
        if obj.type == "LIGHT":
            obj.data.energy = 3.0
            obj.data.angle = 0.2
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    coordinates = nodes.new("ShaderNodeTexCoord")
    split = nodes.new("ShaderNodeSeparateXYZ")
    ramp = nodes.new("ShaderNodeValToRGB")
    low, high = ramp.color_ramp.elements
    low.position, low.color = 0.2, (0.05, 0.06, 0.08, 1)
    high.position, high.color = 0.8, (1.0, 1.0, 1.0, 1)
    links.new(coordinates.outputs["Generated"], split.inputs["Vector"])
    links.new(split.outputs["Z"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Background"].inputs["Color"])


def aim(scene: bpy.types.Scene, point: tuple[float, ...], width: float) -> None:
    """Lets the camera look at a point."""
    scene.camera.location = mathutils.Vector(point) + 6 * TOWARD
    scene.camera.rotation_euler = TOWARD.to_track_quat("Z", "Y").to_euler()
    scene.camera.data.ortho_scale = width


def page(names: list[tuple[str, str]], rows: list[list[np.ndarray]]) -> np.ndarray:
    """Two rows of renders, with two lines of text under each column."""
    below = demo.comparison([(*name, p) for name, p in zip(names, rows[1], strict=True)])
    height, width = rows[0][0].shape[:2]
    above = demo.blank(below.shape[1], height + demo.GAP)
    for k, pixels in enumerate(rows[0]):
        demo.place(above, demo.GAP + k * (width + demo.GAP), demo.GAP, pixels)
    return np.concatenate([above, below])


main(Path(sys.argv[sys.argv.index("--") + 1]))
