# SPDX-License-Identifier: GPL-3.0-or-later

"""Scans a model from ten sides with noise, reconstructs its surface, and makes a picture of both.

Usage: blender --background --python scripts/demo_scan.py -- FOLDER

The extension has to be installed and enabled. Writes FOLDER/reconstruct.png: one scan, all scans,
and the surface; prints how far the surface is from the model.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
import prefilter
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parent))

import demo_scene

SCANS = 10
RAYS = 220  # Along each side of a range image.
WIDTH = 2.9  # Width of a range image, in units of the world.
NOISE = 0.004  # Standard deviation of a range, in units of the world.
DEPTH = 7
POINT_RADIUS = 0.006
COLORS = [(0.85, 0.27, 0.14), (0.05, 0.35, 0.42), (0.90, 0.58, 0.12), (0.35, 0.20, 0.45)]
CLAY = (0.55, 0.50, 0.44)


def main(folder: Path) -> None:
    """Makes the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    model = demo_scene.add_monkey()
    # One closed surface, as a scanner finds it: of eyes and head.
    bpy.ops.prefilter.voxelize(depth=8, interpolant="plane")
    positions, triangles = arrays(model.data)
    model.hide_render = True
    print(f"scanning the model from {SCANS} sides", flush=True)
    tree = BVHTree.FromPolygons(positions.tolist(), triangles.tolist())
    scans = [add_scan(i, *range_image(tree, viewpoint(i), i)) for i in range(SCANS)]

    demo_scene.set_up_render()
    print("rendering the scans", flush=True)
    panels = []
    for title, shown in (("One of ten scans", scans[:1]), ("All ten", scans)):
        for scan in scans:
            scan.hide_render = scan not in shown
        count = sum(len(scan.data.vertices) for scan in shown)
        panels.append((title, f"{count:,} points", demo_scene.render(folder)))

    bpy.ops.object.select_all(action="DESELECT")
    for scan in scans:
        scan.select_set(True)
    bpy.context.view_layer.objects.active = scans[0]
    bpy.ops.prefilter.reconstruct(depth=DEPTH, wavelet="d4")
    surface = bpy.context.object
    surface.data.materials.clear()
    surface.data.materials.append(material("Clay", CLAY))
    print("rendering the surface", flush=True)
    note = f"{len(surface.data.polygons):,} triangles"
    panels.append(("Their surface", note, demo_scene.render(folder)))
    found, _ = arrays(surface.data)
    _, _, distances = prefilter.nearest_points(found, positions, triangles)
    print(f"from the surface to the model: {distances.mean():.5f} on average; noise {NOISE}")
    demo_scene.save(demo_scene.comparison(panels), folder / "reconstruct.png")


def arrays(mesh: bpy.types.Mesh) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Returns the vertices and the triangles of a mesh of triangles."""
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", positions.ravel())
    triangles = np.empty((len(mesh.polygons), 3), np.int32)
    mesh.attributes[".corner_vert"].data.foreach_get("value", triangles.ravel())
    return positions.astype(float), triangles


def viewpoint(index: int) -> Vector:
    """Returns where the scanner stands, on a spiral around the model."""
    height = 1.0 - (2 * index + 1) / SCANS
    turn = index * np.pi * (3.0 - np.sqrt(5.0))
    radius = np.sqrt(1.0 - height**2)
    return 5.0 * Vector((radius * np.cos(turn), radius * np.sin(turn), height))


def range_image(
    tree: BVHTree, eye: Vector, seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the points that parallel rays hit, with noise along the rays, and their normals."""
    turn = eye.to_track_quat("Z", "Y").to_matrix()
    along = -eye.normalized()
    right, up = turn.col[0] * WIDTH, turn.col[1] * WIDTH
    hits = []
    for row in range(RAYS):
        start = eye + up * ((row + 0.5) / RAYS - 0.5) - right * 0.5
        for column in range(RAYS):
            place, _, _, _ = tree.ray_cast(start + right * ((column + 0.5) / RAYS), along)
            if place is not None:
                hits.append(place[:])
    points = np.array(hits)
    points += np.random.default_rng(seed).normal(0.0, NOISE, (len(points), 1)) * np.array(along)
    return points, prefilter.estimate_normals(points, neighbours=24, viewpoint=np.array(eye))


def add_scan(
    index: int, points: NDArray[np.float64], normals: NDArray[np.float64]
) -> bpy.types.Object:
    """Makes an object of points as imports do, which renders show as balls."""
    name = f"Scan {index}"
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(points))
    normal = mesh.attributes.new("normal", "FLOAT_VECTOR", "POINT")
    for attribute, values in ((mesh.attributes["position"], points), (normal, normals)):
        attribute.data.foreach_set("vector", values.astype(np.float32).ravel())
    made = bpy.data.objects.new(name, mesh)
    made.matrix_world = Matrix.Identity(4)
    bpy.context.scene.collection.objects.link(made)
    balls = made.modifiers.new("Balls", "NODES")
    balls.node_group = ball_nodes(material(name, COLORS[index % len(COLORS)]))
    return made


def ball_nodes(shown: bpy.types.Material) -> bpy.types.NodeTree:
    """Returns nodes that turn vertices into balls of a material."""
    group = bpy.data.node_groups.new("Balls", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    nodes, links = group.nodes, group.links
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    balls, painted = nodes.new("GeometryNodeMeshToPoints"), nodes.new("GeometryNodeSetMaterial")
    balls.inputs["Radius"].default_value = POINT_RADIUS
    painted.inputs["Material"].default_value = shown
    links.new(start.outputs[0], balls.inputs["Mesh"])
    links.new(balls.outputs[0], painted.inputs[0])
    links.new(painted.outputs[0], end.inputs[0])
    return group


def material(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    """Returns a matte material."""
    made = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (*color, 1.0)
    made.node_tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    return made


if __name__ == "__main__":
    target = Path(sys.argv[sys.argv.index("--") + 1])
    target.mkdir(parents=True, exist_ok=True)
    main(target)
