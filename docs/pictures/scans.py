"""Renders scans and their surface, a noisy cloud by each basis, and triangles as dense as points.

usage: blender --background --factory-startup --python scans.py -- FOLDER [SHARED]

Writes FOLDER/scans.png, noise.png and density.png. SHARED is the folder of the gathered data,
../shared/data beside the checkout unless it is given; without the bunny's scans there is no
scans.png. The noisy cloud and the uneven one are of Blender's monkey. Without
PREFILTER_POISSONRECON, the path of a built PoissonRecon, noise.png has no Poisson.
"""

import itertools
import math
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import prefilter
from mathutils import Vector
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import demo_scene as demo

from bench.peers.poisson_recon import PoissonRecon
from bench.scans import ply, sets
from bench.scans import scans as range_scans
from bench.voxels.meshes import Triangles

Floats = NDArray[np.floating]
Mesh = tuple[Floats, NDArray[np.integer]]
Panel = tuple[str, str, demo.Array]
SAMPLES = 48
CLAY = (0.45, 0.42, 0.38)
INK = (0.03, 0.05, 0.09)
HUES = np.array(
    [
        (0.86, 0.33, 0.20),
        (0.13, 0.47, 0.51),
        (0.95, 0.72, 0.25),
        (0.36, 0.30, 0.58),
        (0.42, 0.63, 0.33),
        (0.80, 0.45, 0.60),
        (0.24, 0.42, 0.72),
        (0.62, 0.44, 0.28),
        (0.45, 0.72, 0.74),
        (0.55, 0.56, 0.58),
    ]
)
BUNNY_DEPTH = 9
NOISY_DEPTH, NOISY_POINTS = 8, 400_000
UNEVEN_DEPTH, UNEVEN_POINTS = 9, 120_000
SPARSEST = 1 / 400  # Of the densest points' density.


def main(folder: Path, shared: Path) -> None:
    """Makes the pictures."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    set_up_render()
    with tempfile.TemporaryDirectory() as name:
        conf = shared / "points/bunny/bun.conf"
        if conf.exists():
            demo.save(demo.comparison(bunny(conf, Path(name))), folder / "scans.png")
        source = monkey()
        demo.save(noise(source, Path(name)), folder / "noise.png")
        demo.save(demo.comparison(uneven(source, Path(name))), folder / "density.png")


def bunny(conf: Path, folder: Path) -> list[Panel]:
    """The ten range scans, each in a colour, and what becomes of them."""
    placed = [range_scans.placed(*scan) for scan in range_scans.placements(conf)]
    points, normals = (np.concatenate(parts) for parts in zip(*placed, strict=True))
    colors = np.concatenate(
        [np.tile(hue, (len(scan), 1)) for hue, (scan, _) in zip(HUES, placed, strict=True)]
    )
    to_z_up = np.array([(1, 0, 0), (0, 0, -1), (0, 1, 0)])
    points, normals = points @ to_z_up.T, normals @ to_z_up.T
    made = prefilter.reconstruct(points, normals, depth=BUNNY_DEPTH)
    titles = (
        ("Ten scans", f"{len(points):,} points"),
        ("One surface", f"{len(made[1]):,} triangles"),
    )
    middle, size = middle_and_size(points)
    views = (("", middle, 1.3 * size), (", the head", middle + size * HEAD, 0.45 * size))
    panels = []
    for suffix, target, width in views:
        look_at(target, width, turn=-12, tilt=8)
        for (title, note), add in zip(
            titles,
            (lambda: add_points(points, normals, colors, size / 900), lambda: add_surface(made)),
            strict=True,
        ):
            panels.append((title + suffix, note, shot(add(), folder)))
    return panels


HEAD = np.array((-0.22, 0.0, 0.16))  # Of the bunny, from its middle, in its size.


def noise(source: Mesh, folder: Path) -> demo.Array:
    """A cloud with noise of position and normals, by each basis and by Poisson."""
    random = np.random.default_rng(5)
    model = sets.Model.of(Triangles(*source))
    cloud = model.draw(NOISY_POINTS, random)
    cell = sets.cell_of(cloud[0], NOISY_DEPTH)
    points, normals = sets.tilted(cloud, random)
    points = points + random.normal(scale=sets.NOISE * cell, size=points.shape)
    kinds = {
        "Haar": {"wavelet": "haar", "smooth": False, "fit": False},
        "D4": {"wavelet": "d4", "smooth": False, "fit": False},
        "D4 smoothed": {"wavelet": "d4", "smooth": True, "fit": False},
    }
    surfaces = {
        name: prefilter.reconstruct(points, normals, depth=NOISY_DEPTH, **options)
        for name, options in kinds.items()
    }
    if not PoissonRecon.missing():
        files = folder / "points.ply", folder / "poisson.ply"
        ply.write_points(files[0], len(points), [(points, normals.astype(np.float32))])
        PoissonRecon(*files, NOISY_DEPTH).measure()
        read = ply.read_mesh(files[1])
        surfaces["Screened Poisson"] = read.positions, read.triangles
    color = np.tile(HUES[1], (len(points), 1))
    rows = []
    for target, width in (((0.0, 0.0, 0.0), 2.7), (EYE, 0.62)):
        look_at(np.array(target), width, turn=24, tilt=6)
        notes = {"Points": f"{len(points):,}, noise of half a cell"}
        panels = [
            ("Points", notes["Points"], shot(add_points(points, normals, color, 0.0022), folder))
        ]
        for name, surface in surfaces.items():
            panels.append(
                (name, f"{len(surface[1]):,} triangles", shot(add_surface(surface), folder))
            )
        rows.append(panels)
    whole, close = (demo.comparison(row) for row in rows)
    return np.concatenate([whole[: demo.GAP + demo.PANEL_HEIGHT], close])


EYE = (-0.38, -0.8, 0.22)  # Of the monkey, the right one.


def uneven(source: Mesh, folder: Path) -> list[Panel]:
    """Points that thin out to one side, and the triangles of their surface."""
    random = np.random.default_rng(6)
    drawn = sets.Model.of(Triangles(*source)).draw(UNEVEN_POINTS * 4, random)
    low, high = drawn[0][:, 0].min(), drawn[0][:, 0].max()
    share = SPARSEST ** ((drawn[0][:, 0] - low) / (high - low))
    kept = random.random(len(share)) < share
    points, normals = drawn[0][kept], drawn[1][kept]
    made = prefilter.reconstruct(points, normals, depth=UNEVEN_DEPTH)
    color = np.tile(HUES[1], (len(points), 1))
    panels = []
    for target, width, suffix in (((0.0, 0.0, 0.0), 2.7, ""), (BROW, 0.7, ", between the eyes")):
        look_at(np.array(target), width, turn=8, tilt=6)
        dots = shot(add_points(points, normals, color, 0.0012 * width), folder)
        panels.append(("Points" + suffix, f"{len(points):,}", dots))
        lines = shot(add_surface(made, wires=width / 500), folder)
        panels.append(("Triangles" + suffix, f"{len(made[1]):,}", lines))
    return panels


BROW = (0.0, -0.7, 0.2)


def monkey() -> Mesh:
    """Blender's monkey as one closed surface: its own parts cross each other."""
    obj = demo.add_monkey()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    mesh.calc_loop_triangles()
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    triangles = np.empty((len(mesh.loop_triangles), 3), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles.ravel())
    bpy.data.objects.remove(obj)
    octree = prefilter.voxelize(positions, triangles, depth=9)
    positions, triangles = octree.contour(interpolant="plane", cleanup=True)
    return positions.astype(float), triangles.astype(np.int64)


def middle_and_size(points: Floats) -> tuple[Floats, float]:
    """Returns the middle of the points' box, and its longest side."""
    low, high = points.min(axis=0), points.max(axis=0)
    return (low + high) / 2, float((high - low).max())


def look_at(target: Floats, width: float, *, turn: float, tilt: float) -> None:
    """Points the camera at a place; `width` is what it sees, angles in degrees."""
    camera = bpy.context.scene.camera
    yaw, pitch = math.radians(turn), math.radians(tilt)
    back = Vector(
        (math.sin(yaw) * math.cos(pitch), -math.cos(yaw) * math.cos(pitch), math.sin(pitch))
    )
    camera.data.ortho_scale = width
    camera.location = Vector(target) + 20 * back
    camera.rotation_euler = back.to_track_quat("Z", "Y").to_euler()


def set_up_render() -> None:
    """Chooses light that shows relief: a low sun, and some from everywhere."""
    demo.set_up_render()
    scene = bpy.context.scene
    scene.cycles.samples = SAMPLES
    scene.cycles.max_bounces = 2
    sun = next(obj for obj in scene.objects if obj.type == "LIGHT")
    sun.data.energy = 3.0
    sun.data.angle = math.radians(3)
    sun.rotation_euler = (math.radians(58), 0, math.radians(-52))
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.4
    scene.camera.data.clip_end = 1000


def shot(obj: bpy.types.Object, folder: Path) -> demo.Array:
    """Renders an object, and removes it."""
    picture = demo.render(folder)
    data = obj.data
    bpy.data.objects.remove(obj)
    bpy.data.meshes.remove(data)
    return picture


def add_surface(surface: Mesh, *, wires: float = 0.0) -> bpy.types.Object:
    """Adds a mesh of clay; with `wires`, the width of its edges, flat and with its edges."""
    positions, triangles = surface
    obj = new_object(positions, triangles)
    mesh = obj.data
    mesh.polygons.foreach_set("use_smooth", np.full(len(triangles), wires == 0))
    material = bpy.data.materials.new("Clay")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*CLAY, 1)
    shader.inputs["Roughness"].default_value = 0.55
    mesh.materials.append(material)
    if wires:
        nodes, links = material.node_tree.nodes, material.node_tree.links
        edges = nodes.new("ShaderNodeWireframe")
        edges.inputs["Size"].default_value = wires
        mix = nodes.new("ShaderNodeMix")
        mix.data_type = "RGBA"
        mix.inputs[6].default_value, mix.inputs[7].default_value = (*CLAY, 1), (*INK, 1)
        links.new(edges.outputs[0], mix.inputs[0])
        links.new(mix.outputs[2], shader.inputs["Base Color"])
    return obj


def add_points(points: Floats, normals: Floats, colors: Floats, radius: float) -> bpy.types.Object:
    """Adds points as dots of sRGB colours, lit as the surface that they are on would be."""
    obj = new_object(points, np.empty((0, 3), np.int32))
    sun = next(obj for obj in bpy.context.scene.objects if obj.type == "LIGHT")
    to_sun = np.array(sun.matrix_world.to_3x3().col[2])
    light = 0.35 + 0.75 * np.clip(normals @ to_sun, 0, 1)
    linear = prefilter.to_linear(colors.astype(np.float32)[None])[0] * light[:, None]
    attribute = obj.data.color_attributes.new("Light", "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", np.c_[linear, np.ones(len(linear))].ravel())
    material = bpy.data.materials.new("Dots")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    color = nodes.new("ShaderNodeAttribute")
    color.attribute_name = "Light"
    emission = nodes.new("ShaderNodeEmission")
    links.new(color.outputs["Color"], emission.inputs["Color"])
    links.new(emission.outputs[0], nodes["Material Output"].inputs["Surface"])

    tree = bpy.data.node_groups.new("Balls", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    kinds = ("NodeGroupInput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial")
    steps = [tree.nodes.new(kind) for kind in (*kinds, "NodeGroupOutput")]
    for start, end in itertools.pairwise(steps):
        tree.links.new(start.outputs[0], end.inputs[0])
    steps[1].inputs["Radius"].default_value = radius
    steps[2].inputs["Material"].default_value = material
    obj.modifiers.new("Balls", "NODES").node_group = tree
    return obj


def new_object(positions: Floats, triangles: NDArray[np.integer]) -> bpy.types.Object:
    """Adds a mesh, fast."""
    mesh = bpy.data.meshes.new("Surface")
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", np.asarray(positions, np.float32).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", np.asarray(triangles, np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(len(triangles), dtype=np.int32) * 3)
    mesh.update(calc_edges=True)
    obj = bpy.data.objects.new("Surface", mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    main(Path(arguments[0]), Path(arguments[1]) if len(arguments) > 1 else sets.SHARED)
