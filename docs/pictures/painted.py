# SPDX-License-Identifier: GPL-3.0-or-later

"""Renders colored points, large triangles with their colors at the vertices, and with a texture.

usage: blender --background --python painted.py -- TARGET.png
"""

import sys
import tempfile
from pathlib import Path

import addon_utils
import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
sys.path.insert(0, str(Path(__file__).resolve().parent))
import demo_scene as demo
import scans

from bench.points import sets
from bench.voxels.meshes import Triangles

PACKAGE = "bl_ext.user_default.prefilter"
POINTS = 400_000
DEPTH = 8
ADAPTIVITY = 0.1  # Cells.
SIZE = 1024
VIEW = scans.View((-0.12, 0.0, 0.0), 2.9, -20, 4, dot=0.0018)
COLOR = "Col"


def main(target: Path) -> None:
    """Makes the picture."""
    assert addon_utils.enable(PACKAGE) is not None
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scans.set_up_render()
    scans.look(VIEW)
    random = np.random.default_rng(7)
    points, normals = sets.Model.of(Triangles(*scans.monkey())).draw(POINTS, random)
    colors = demo.pattern(points)[:, :3]
    positions, triangles, found = prefilter.reconstruct(
        points, normals, attributes=colors, depth=DEPTH, adaptivity=ADAPTIVITY
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        dots = scans.add_points(points, normals, colors, VIEW.dot * VIEW.width)
        panels = [("Scan", f"{POINTS:,} points", demo.render(folder))]
        bpy.data.objects.remove(dots)
        surface = scans.new_object(positions, triangles)
        surface.data.polygons.foreach_set("use_smooth", np.ones(len(triangles), bool))
        show_vertices(surface, found)
        count = f"{len(triangles):,} triangles"
        panels.append(("Colors of vertices", count, demo.render(folder)))
        add_texture(surface, points, colors)
        panels.append(("Colors to Texture", f"{SIZE} x {SIZE} texels", demo.render(folder)))
    demo.save(demo.comparison(panels), target)


def show_vertices(surface: bpy.types.Object, colors: NDArray[np.floating]) -> None:
    """Gives a mesh a material that shows its sRGB vertex colors."""
    add_colors(surface.data, colors)
    material = bpy.data.materials.new("Vertices")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    color = nodes.new("ShaderNodeVertexColor")
    color.layer_name = COLOR
    links.new(color.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.55
    surface.data.materials.append(material)


def add_texture(
    surface: bpy.types.Object, points: NDArray[np.floating], colors: NDArray[np.floating]
) -> None:
    """Selects the scan, then the mesh, and runs Colors to Texture, as a user does."""
    cloud = scans.new_object(points, np.empty((0, 3), np.int32))
    add_colors(cloud.data, colors)
    cloud.select_set(True)
    surface.select_set(True)
    bpy.context.view_layer.objects.active = surface
    assert bpy.ops.prefilter.paint_texture(size=SIZE) == {"FINISHED"}
    bpy.data.objects.remove(cloud)


def add_colors(mesh: bpy.types.Mesh, colors: NDArray[np.floating]) -> None:
    """Adds sRGB colors to the vertices of a mesh, as its active ones."""
    layer = mesh.color_attributes.new(COLOR, "FLOAT_COLOR", "POINT")
    linear = prefilter.to_linear(np.asarray(colors, np.float32)[None])[0]
    layer.data.foreach_set("color", np.c_[linear, np.ones(len(linear))].ravel())
    mesh.color_attributes.active_color = layer


if __name__ == "__main__":
    main(Path(sys.argv[sys.argv.index("--") + 1]))
