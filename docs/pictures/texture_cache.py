# SPDX-License-Identifier: GPL-3.0-or-later

"""Renders the demo's model from afar: with its texture, with Blender's cache, and with PAM in it.

usage: blender --background --python-exit-code 1 --python texture_cache.py -- TARGET.png
(Blender 5.2 or later)
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import demo_scene as demo

ENLARGED = 5
SAMPLES = 256


def main(target: Path) -> None:
    """Makes the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    obj = demo.add_monkey()
    pixels = demo.paint(demo.read_model(obj))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        buffer = oiio.ImageBuf(np.ascontiguousarray(pixels[::-1]))
        assert buffer.write(str(folder / "paint.png"), "uint8")
        demo.add_material(obj, bpy.data.images.load(str(folder / "paint.png")))
        demo.set_up_render()
        scene = bpy.context.scene
        scene.cycles.samples = SAMPLES
        scene.cycles.pixel_filter_type = "BOX"
        scene.render.resolution_x = demo.PANEL_WIDTH // ENLARGED
        scene.render.resolution_y = demo.PANEL_HEIGHT // ENLARGED

        scene.render.use_texture_cache = False
        full = demo.render(folder)
        panels = [("Full texture", "no cache", large(full))]
        scene.render.use_texture_cache = True
        for label, bake in (
            ("Blender's cache", bpy.ops.render.generate_texture_cache),
            ("PAM in the cache", bpy.ops.prefilter.bake_texture_cache),
        ):
            bake()
            seen = demo.render(folder)
            difference = prefilter.to_linear(seen) - prefilter.to_linear(full)
            covered = np.any(full != demo.PAPER, axis=2)
            error = float(np.sqrt(np.mean(difference[covered] ** 2)))
            panels.append((label, f"error {error:.3f}", large(seen)))
    demo.save(demo.comparison(panels), target)


def large(pixels: demo.Array) -> demo.Array:
    """Returns a picture enlarged without interpolation."""
    return np.repeat(np.repeat(pixels, ENLARGED, axis=0), ENLARGED, axis=1)


main(Path(sys.argv[sys.argv.index("--") + 1]))
