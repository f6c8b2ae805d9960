# SPDX-License-Identifier: GPL-3.0-or-later

"""Rasterizes a text small, by one sample a pixel and by filters, and enlarges the pixels.

usage: blender --background --python text.py -- TARGET.png
"""

import sys
from pathlib import Path

import bpy
import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import demo_scene as demo

TEXT = "Sphinx of black quartz,\njudge my vow. 0123456789"
WIDTH, HEIGHT = 128, 32
SAMPLES = 32  # Along a pixel's side, of the picture that is sampled.
ENLARGED = 5
ROWS = (
    ("", "One sample per pixel"),
    ("box", "Box"),
    ("mitchell", "Mitchell"),
    ("lanczos3", "Lanczos 3"),
)


def main(target: Path) -> None:
    """Makes the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    curve = bpy.data.curves.new("Text", "FONT")
    curve.body = TEXT
    text = bpy.data.objects.new("Text", curve)
    bpy.context.scene.collection.objects.link(text)
    text.select_set(True)
    bpy.context.view_layer.objects.active = text
    material = bpy.data.materials.new("Ink")
    material.diffuse_color = (0.01, 0.02, 0.05, 1.0)
    if material.node_tree is not None:
        material.node_tree.nodes.clear()
    curve.materials.append(material)
    cell_width, cell_height = ENLARGED * WIDTH, ENLARGED * HEIGHT
    page = demo.blank(cell_width + 2 * demo.GAP, len(ROWS) * (cell_height + 64) + demo.GAP)
    for row, (name, title) in enumerate(ROWS):
        pixels = rasterized(name)
        top = demo.GAP + row * (cell_height + 64)
        enlarged = pixels.repeat(ENLARGED, axis=0).repeat(ENLARGED, axis=1)
        demo.place(page, demo.GAP, top, enlarged)
        center = demo.GAP + cell_width // 2
        demo.write(page, center, top + cell_height + 28, title, 24)
    demo.save(page, target)


def rasterized(name: str) -> np.ndarray:
    """Returns (HEIGHT, WIDTH, 3) sRGB values, rows from the top; without a filter, of samples."""
    scale = 1 if name else SAMPLES
    before = set(bpy.data.images)
    bpy.ops.prefilter.rasterize(
        width=scale * WIDTH,
        height=scale * HEIGHT,
        margin=2.0 * scale,
        filter=name or "box",
        background="color",
        background_color=(1.0, 1.0, 1.0, 1.0),
        pixel_type="float",
    )
    (image,) = set(bpy.data.images) - before
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    light = values.reshape(image.size[1], image.size[0], -1)[
        scale // 2 :: scale, scale // 2 :: scale
    ]
    return np.clip(prefilter.to_srgb(np.ascontiguousarray(light)), 0.0, 1.0)[::-1, :, :3]


main(Path(sys.argv[-1]))
