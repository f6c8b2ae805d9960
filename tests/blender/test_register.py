"""The add-on comes and goes without a trace."""

import addon_utils
import bpy
from conftest import PACKAGE


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
    defaults = addon("bake").Settings()
    scene = bpy.context.scene.prefilter_bake
    operator = bpy.ops.prefilter.bake_mipmaps.get_rna_type().properties
    for name in addon("settings").BakeProperties.__annotations__:
        assert getattr(scene, name) == getattr(defaults, name)
        assert operator[name].description
