# SPDX-License-Identifier: GPL-3.0-or-later

"""The add-on comes and goes without a trace."""

import dataclasses

import addon_utils
import bpy
import pytest
from conftest import PACKAGE

OPERATORS = ("PREFILTER_OT_voxelize", "PREFILTER_OT_boolean", "PREFILTER_OT_rasterize")
PANELS = ("PREFILTER_PT_voxelize", "PREFILTER_PT_boolean", "PREFILTER_PT_shapes")


def test_subjects_come_and_go():
    for is_there in (True, False, True):
        for name in (*OPERATORS, *PANELS):
            assert hasattr(bpy.types, name) == is_there
        for name in ("prefilter_voxelize", "prefilter_boolean", "prefilter_rasterize"):
            assert hasattr(bpy.types.Scene, name) == is_there
        assert hasattr(bpy.types.Image, "prefilter_drawn") == is_there
        if is_there:
            addon_utils.disable(PACKAGE, default_set=True)
        else:
            assert addon_utils.enable(PACKAGE, default_set=True) is not None
    assert addon_utils.enable(PACKAGE, default_set=True) is not None


def test_unregister_is_symmetric():
    for _ in range(2):
        assert hasattr(bpy.types, "PREFILTER_OT_bake_mipmaps")
        assert hasattr(bpy.types, "PREFILTER_PT_bake")
        assert hasattr(bpy.types.Scene, "prefilter_bake")
        assert hasattr(bpy.types, "PREFILTER_PT_preview")
        assert hasattr(bpy.types.WindowManager, "prefilter_view")
        addon_utils.disable(PACKAGE, default_set=True)
        assert not hasattr(bpy.types, "PREFILTER_OT_bake_mipmaps")
        assert not hasattr(bpy.types, "PREFILTER_PT_bake")
        assert not hasattr(bpy.types, "PREFILTER_PT_preview")
        assert not hasattr(bpy.types.Scene, "prefilter_bake")
        assert not hasattr(bpy.types.WindowManager, "prefilter_view")
        assert addon_utils.enable(PACKAGE, default_set=True) is not None


def test_settings_of_scene_operator_and_bake_agree(addon):
    choices = addon("textures.choices")
    defaults = {**vars(choices.Settings()), **vars(choices.ResultSettings())}
    scene = bpy.context.scene.prefilter_bake
    operator = bpy.ops.prefilter.bake_mipmaps.get_rna_type().properties
    for name in addon("textures.properties").BakeProperties.__annotations__:
        assert getattr(scene, name) == defaults[name]
        assert operator[name].description


@pytest.mark.parametrize("name", ["voxelize", "boolean"])
def test_settings_of_voxels_agree(addon, name):
    defaults = getattr(addon("voxels.choices"), f"{name.capitalize()}Settings")()
    scene = getattr(bpy.context.scene, f"prefilter_{name}").to_settings()
    operator = getattr(bpy.ops.prefilter, name).get_rna_type().properties
    for field in dataclasses.fields(defaults):
        assert getattr(scene, field.name) == pytest.approx(getattr(defaults, field.name))
        assert field.name == "threads" or operator[field.name].description
