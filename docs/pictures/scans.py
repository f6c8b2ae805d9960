# SPDX-License-Identifier: GPL-3.0-or-later

"""Renders scans and their surface, a noisy cloud by each basis, and triangles as dense as points.

usage: blender --background --python scans.py -- FOLDER [SHARED]

Writes FOLDER/scans.png, noise.png and density.png. SHARED is the folder of the gathered data,
../shared/data beside the checkout unless it is given; without the bunny's scans there is no
scans.png. The noisy cloud and the uneven one are of Blender's monkey. Without
PREFILTER_POISSONRECON, the path of a built PoissonRecon, noise.png has no Poisson.
"""

import itertools
import math
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
from bench.points import ply, sets
from bench.points import scans as range_scans
from bench.voxels.meshes import Triangles

Floats = NDArray[np.floating]
Mesh = tuple[Floats, NDArray[np.integer]]
Panel = tuple[str, str, demo.Array]
SAMPLES = 24
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
BUNNY_DEPTH = 8
NOISY_DEPTH, NOISY_POINTS = 8, 400_000
UNEVEN_DEPTH, UNEVEN_POINTS = 8, 800_000  # Before they are thinned out.
SPARSEST = 1 / 40  # Relative to the greatest density.
KINDS = {
    "Haar": {"wavelet": "haar", "smooth": False, "fit": False},
    "D4": {"wavelet": "d4", "smooth": False, "fit": False},
    "D4 smoothed": {"wavelet": "d4", "smooth": True, "fit": False},
}


@dataclass(frozen=True)
class View:
    """A view of the camera: a position, a width, and angles in degrees.

    `dot` is the radius of points, and `edge` the width of edges, both in widths of the view.
    """

    target: tuple[float, float, float]
    width: float
    turn: float
    tilt: float
    dot: float
    edge: float = 0.0


@dataclass(frozen=True)
class Subject:
    """A mesh or cloud, and the lines under it."""

    title: str
    note: str
    add: Callable[[View], bpy.types.Object]


# The bunny's coordinates are in meters, with z upwards.
BUNNY_VIEWS = (
    View((-0.017, 0.0, 0.11), 0.2, -12, 8, dot=0.0011),
    View((-0.062, 0.0, 0.137), 0.075, -38, 8, dot=0.0026),
)
NOISE_VIEWS = (
    View((-0.12, 0.0, 0.0), 2.9, -20, 4, dot=0.0011),
    View((-0.38, -0.8, 0.27), 0.8, -20, 4, dot=0.0022),
)
UNEVEN_VIEWS = (
    View((-0.12, 0.0, 0.0), 2.9, -20, 4, dot=0.0011, edge=0.0006),
    View((0.03, -0.7, -0.22), 0.8, -20, 4, dot=0.003, edge=0.002),
)


def main(folder: Path, shared: Path) -> None:
    """Makes the pictures."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    set_up_render()
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        conf = shared / "points/bunny/bun.conf"
        if conf.exists():
            first, second = shots(bunny(conf), BUNNY_VIEWS, work)
            demo.save(demo.comparison([*first, *second]), folder / "scans.png")
        source = monkey()
        whole, close = map(demo.comparison, shots(noisy(source, work), NOISE_VIEWS, work))
        page = np.concatenate([whole[: demo.GAP + demo.PANEL_HEIGHT], close])
        demo.save(page, folder / "noise.png")
        first, second = shots(uneven(source), UNEVEN_VIEWS, work)
        demo.save(demo.comparison([*first, *second]), folder / "density.png")


def shots(subjects: Sequence[Subject], views: Sequence[View], folder: Path) -> list[list[Panel]]:
    """Renders all subjects in each view."""
    found = []
    for view in views:
        look(view)
        panels = []
        for subject in subjects:
            obj = subject.add(view)
            panels.append((subject.title, subject.note, demo.render(folder)))
            mesh = obj.data
            bpy.data.objects.remove(obj)
            bpy.data.meshes.remove(mesh)
        found.append(panels)
    return found


def bunny(conf: Path) -> list[Subject]:
    """The ten range scans, each in a color, and their surface."""
    placed = [range_scans.placed(*scan) for scan in range_scans.placements(conf)]
    points, normals = (np.concatenate(parts) for parts in zip(*placed, strict=True))
    colors = np.concatenate(
        [np.tile(hue, (len(scan), 1)) for hue, (scan, _) in zip(HUES, placed, strict=True)]
    )
    to_z_up = np.array([(1, 0, 0), (0, 0, -1), (0, 1, 0)])
    points, normals = points @ to_z_up.T, normals @ to_z_up.T
    made = prefilter.reconstruct(points, normals, depth=BUNNY_DEPTH)
    return [dots("Ten scans", points, normals, colors), surface("One surface", made)]


def noisy(source: Mesh, folder: Path) -> list[Subject]:
    """A cloud with noise of position and normals, by each basis and by Poisson."""
    random = np.random.default_rng(5)
    cloud = sets.Model.of(Triangles(*source)).draw(NOISY_POINTS, random)
    cell = sets.cell_of(cloud[0], NOISY_DEPTH)
    points, normals = sets.tilted(cloud, random)
    points = points + random.normal(scale=sets.NOISE * cell, size=points.shape)
    subjects = [dots("Points", points, normals, HUES[1])]
    for name, options in KINDS.items():
        made = prefilter.reconstruct(points, normals, depth=NOISY_DEPTH, **options)
        subjects.append(surface(name, made))
    if not PoissonRecon.missing():
        file, target = folder / "points.ply", folder / "poisson.ply"
        ply.write_points(file, len(points), [(points, normals)])
        PoissonRecon(file, target, NOISY_DEPTH).measure()
        read = ply.read_mesh(target)
        subjects.append(surface("Screened Poisson", (read.positions, read.triangles)))
    return subjects


def uneven(source: Mesh) -> list[Subject]:
    """Points that thin out downwards, and the triangles of their surface."""
    random = np.random.default_rng(6)
    points, normals = sets.Model.of(Triangles(*source)).draw(UNEVEN_POINTS, random)
    low, high = points[:, 2].min(), points[:, 2].max()
    share = SPARSEST ** ((high - points[:, 2]) / (high - low))
    kept = random.random(len(share)) < share
    points, normals = points[kept], normals[kept]
    made = prefilter.reconstruct(points, normals, depth=UNEVEN_DEPTH)
    return [dots("Points", points, normals, HUES[1]), surface("Triangles", made, has_edges=True)]


def dots(title: str, points: Floats, normals: Floats, colors: Floats) -> Subject:
    """Points, in one color or a color per point."""
    each = np.broadcast_to(colors, points.shape)
    return Subject(
        title,
        f"{len(points):,} points",
        lambda view: add_points(points, normals, each, view.dot * view.width),
    )


def surface(title: str, mesh: Mesh, *, has_edges: bool = False) -> Subject:
    """A surface, smooth or with its edges."""
    return Subject(
        title,
        f"{len(mesh[1]):,} triangles",
        lambda view: add_surface(mesh, wires=view.edge * view.width if has_edges else 0.0),
    )


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
    closed = prefilter.close_holes(positions, triangles)
    octree = prefilter.voxelize(closed.positions, closed.triangles, depth=9)
    positions, triangles = octree.contour(interpolant="plane", cleanup=True)
    return positions.astype(float), triangles.astype(np.int64)


def look(view: View) -> None:
    """Places the camera."""
    camera = bpy.context.scene.camera
    yaw, pitch = math.radians(view.turn), math.radians(view.tilt)
    back = Vector(
        (math.sin(yaw) * math.cos(pitch), -math.cos(yaw) * math.cos(pitch), math.sin(pitch))
    )
    camera.data.ortho_scale = view.width
    camera.location = Vector(view.target) + 20 * back
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


def add_surface(mesh: Mesh, *, wires: float = 0.0) -> bpy.types.Object:
    """Adds a mesh of clay; with `wires`, the width of its edges, flat and with its edges."""
    positions, triangles = mesh
    obj = new_object(positions, triangles)
    obj.data.polygons.foreach_set("use_smooth", np.full(len(triangles), wires == 0))
    material = bpy.data.materials.new("Clay")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*CLAY, 1)
    shader.inputs["Roughness"].default_value = 0.55
    obj.data.materials.append(material)
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
    """Adds points as dots of sRGB colors, lit as the surface that they are on would be."""
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
