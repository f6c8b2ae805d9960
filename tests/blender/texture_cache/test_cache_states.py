# SPDX-License-Identifier: GPL-3.0-or-later

"""The panel's summary of a scene's images and their cache files."""

import os

import bpy
import cycles_scenes as cycles
import numpy as np
import pytest
import scenes
from cycles_scenes import smooth


@pytest.mark.usefixtures("scene")
def test_the_panel_lists_states_of_images(tmp_path, addon, monkeypatch):
    module = addon("texture_cache.states")
    monkeypatch.setattr(module, "_SECONDS", -1.0)
    monkeypatch.setattr(addon("core.scene_cache"), "SHARE_OF_TIME", 1e9)
    cycles.shown_on(cycles.write_picture(tmp_path / "a.png", smooth(64, 64, 3), "uint8"), name="A")
    cycles.shown_on(cycles.write_picture(tmp_path / "b.exr", smooth(64, 64, 3), "half"), name="B")
    flat = np.full((64, 64, 3), 0.5, np.float32)
    cycles.shown_on(cycles.write_picture(tmp_path / "flat.png", flat, "uint8"), name="Flat")

    def said():
        scenes.depsgraph()
        found = module.states(bpy.context)
        return module.summary(found), {one.name: one.state for one in found}

    assert said()[0] == "3 not baked"
    bpy.ops.render.generate_texture_cache()
    assert said()[1] == {"a.png": "missing", "b.exr": "missing", "flat.png": "baked"}
    bpy.ops.prefilter.bake_texture_cache()
    assert said()[0] == "3 baked"
    os.utime(tmp_path / "b.exr", (1.6e9, 1.6e9))
    assert said() == ("2 baked, 1 stale", {"a.png": "baked", "b.exr": "stale", "flat.png": "baked"})
    bpy.ops.render.generate_texture_cache()
    assert said()[1]["b.exr"] == "missing"
    bpy.data.images["a.png"].pack()
    bpy.context.view_layer.update()
    made = bpy.data.images.new("Made", 4, 4)
    cycles.shown_on(made, name="Made")
    assert said()[0] == "1 baked, 1 not baked, 1 packed, 1 without a file"
