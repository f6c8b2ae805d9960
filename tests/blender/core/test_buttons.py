# SPDX-License-Identifier: GPL-3.0-or-later

"""Buttons in panels and menus hand the settings of the scene over to their operators."""

from types import SimpleNamespace

import bpy


class Layout:
    """Records the operator that a button draws."""

    def operator(self, name, **more):
        self.name, self.more = name, more
        return SimpleNamespace()


def test_a_button_has_the_settings_of_the_scene(addon):
    bpy.context.scene.prefilter_voxelize.depth = 5
    layout = Layout()
    made = addon("voxels.panel")._VOXELIZE.draw(layout, bpy.context, is_changed=True)
    assert (layout.name, made.depth) == ("prefilter.voxelize", 5)
    assert layout.more == {"text": None, "icon": "MOD_REMESH"}
    addon("voxels.panel")._VOXELIZE.draw(layout, bpy.context, "Again", "X")
    assert layout.more == {"text": "Again", "icon": "X"}


def test_a_button_passes_no_settings_to_operators_that_read_the_scene(addon):
    """So that Blender finds the key of the operator."""
    assert not vars(addon("voxels.panel")._VOXELIZE.draw(Layout(), bpy.context))
    table = addon("images.panels.sampling_table")._BUTTON.draw(Layout(), bpy.context)
    assert table.filter == bpy.context.scene.prefilter_sampling_table.filter


def test_a_button_passes_the_right_setting_of_two_with_one_name(addon):
    """A model bake has its own choice of objects, and no settings that it determines itself."""
    bpy.context.scene.prefilter_model.objects = "selected"
    made = addon("textures.menus").MODEL_BUTTON.draw(Layout(), bpy.context, is_changed=True)
    assert made.objects == "selected"
    assert made.filter == bpy.context.scene.prefilter_model.filter
    assert not hasattr(made, "content")
