# SPDX-License-Identifier: GPL-3.0-or-later

"""Renders the demo's model with a coarse level, with and without seams in the fit, and its seams.

usage: blender --background --python-exit-code 1 --python seams.py -- TARGET.png
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import demo_scene as demo

from bench.textures import sampling

LEVEL = 5
BUDGETS = (0.0, 0.01)
LINE = 0.008  # Half the width of a line on the model.
VIEW = 1.1  # Size of the view of the forehead.
SHIFT = (-0.32, 0.45)  # Shift to it, in views.
MAGENTA = (1.0, 0.0, 1.0, 1.0)


def main(target: Path) -> None:
    """Makes the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    obj = demo.add_monkey()
    model = demo.read_model(obj)
    image = prefilter.to_linear(demo.paint(model))
    node = demo.add_material(obj, float_image("Full", image))
    demo.set_up_render()
    camera = bpy.context.scene.camera.data
    camera.ortho_scale, (camera.shift_x, camera.shift_y) = VIEW, SHIFT
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        seams = sampling.seam_lines(model.corners, model.uvs)
        lines = draw(seams)
        side = demo.TEXTURE_SIZE
        panels = [("Its seams", f"full texture, {side} x {side}", demo.render(folder))]
        bpy.data.objects.remove(lines)
        for budget in BUDGETS:
            levels = prefilter.mipmaps(image, model.surface, levels=LEVEL + 1, seam_budget=budget)
            contrast = seams.contrast(levels[LEVEL], "clamp")
            (error,) = prefilter.mipmap_error(levels, image, model.surface, [LEVEL])
            node.image = float_image(f"Budget {budget:g}", levels[LEVEL])
            note = f"contrast {contrast:.3f}, error {error:.3f}"
            panels.append((f"Level {LEVEL}, seams {100 * budget:g} %", note, demo.render(folder)))
    demo.save(demo.comparison(panels), target)


def float_image(name: str, values: demo.Array) -> bpy.types.Image:
    """Makes an image datablock of scene-linear floats, which Cycles interpolates unchanged."""
    height, width = values.shape[:2]
    image = bpy.data.images.new(name, width, height, float_buffer=True, is_data=True)
    opaque = np.concatenate([values, np.ones((height, width, 1), np.float32)], axis=2)
    image.pixels.foreach_set(opaque.ravel())
    image.update()
    return image


def draw(seams: sampling.SeamLines) -> bpy.types.Object:
    """Adds the seams as lines."""
    curve = bpy.data.curves.new("Seams", "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = LINE
    for ends in seams.ends:
        line = curve.splines.new("POLY")
        line.points.add(1)
        line.points.foreach_set("co", np.c_[ends, np.ones(2)].ravel())
    material = bpy.data.materials.new("Line")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = MAGENTA
    output = nodes["Material Output"]
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    curve.materials.append(material)
    obj = bpy.data.objects.new("Seams", curve)
    bpy.context.scene.collection.objects.link(obj)
    return obj


main(Path(sys.argv[sys.argv.index("--") + 1]))
