# SPDX-License-Identifier: GPL-3.0-or-later

"""Plots the error of filters on the demo's model.

usage: blender --background --python error.py -- TARGET.png
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import demo_scene

bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
obj = demo_scene.add_monkey()
image = demo_scene.new_image(demo_scene.paint(demo_scene.read_model(obj)))
demo_scene.add_material(obj, image)
obj.select_set(True)
bpy.ops.prefilter.plot_error(image=image.name)
plot = bpy.data.images[f"{image.name}.error"]
plot.filepath_raw, plot.file_format = sys.argv[-1], "PNG"
plot.save()
