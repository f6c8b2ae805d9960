# SPDX-License-Identifier: GPL-3.0-or-later

"""The operator, as scripts call it."""

import bpy
import pytest
import scenes
from texture_readers import read_dds


def bake(**options):
    return bpy.ops.prefilter.bake_mipmaps(**options)


def test_bakes_by_name():
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    assert bake(image="Paint") == {"FINISHED"}
    assert tuple(bpy.data.images["Paint.mip03"].size) == (1, 1)
    assert bpy.data.images["Paint.mip01"].packed_file is not None


def test_without_an_editor_the_active_material_says_which():
    image = scenes.image("Paint", scenes.noise(8, 8))
    quad = scenes.textured_quad(image)
    assert bake(levels=2) == {"FINISHED"}
    assert "Paint.mip01" in bpy.data.images
    scenes.image_node(quad.active_material.node_tree, scenes.image("Other", scenes.noise(8, 8)))
    with pytest.raises(RuntimeError, match="active object has no single base color image"):
        bake(levels=2)


def test_invoke_in_the_background_executes():
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    assert bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", image="Paint") == {"FINISHED"}
    assert "Paint.mip03" in bpy.data.images


def test_says_what_it_did(capfd):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    bake(image="Paint", levels=3)
    assert (
        "Baked 'Paint' with PAM Bilinear over 1 object into 2 level images"
        in capfd.readouterr().out
    )


def test_warns_of_what_it_left_out(capfd):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    bare = scenes.textured_quad(image, "NoMap")
    bare.data.uv_layers.remove(bare.data.uv_layers[0])
    assert bake(image="Paint") == {"FINISHED"}
    assert "Warning: object 'NoMap' has no UV map" in capfd.readouterr().out


def test_object_in_edit_mode_counts():
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    bpy.ops.object.mode_set(mode="EDIT")
    assert bake(image="Paint", objects="selected") == {"FINISHED"}


def test_file_beside_the_blend(tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bake(image="Paint", use_images=False, filepath="//paint.exr")
    assert (tmp_path / "paint.exr").exists()
    assert "Paint.mip01" not in bpy.data.images


def test_file_for_engines(tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    path = tmp_path / "out.dds"
    options = {"image": "Paint", "filepath": str(path), "texture_format": "bc3"}
    assert bake(**options, use_images=False) == {"FINISHED"}
    assert read_dds(path).format == "BC3_SRGB"


def test_poll_without_images():
    assert not bpy.ops.prefilter.bake_mipmaps.poll()
    with pytest.raises(RuntimeError, match="no image in this file"):
        bake(image="Paint")


def test_frames_and_instances():
    image = scenes.image("Paint", scenes.noise(8, 8))
    quad = scenes.textured_quad(image)
    scenes.collection_instance(quad).select_set(True)
    bpy.context.scene.frame_set(5)
    assert bake(image="Paint", use_frames=True, frame_start=2, frame_end=4) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 5
    assert "Paint.mip03" in bpy.data.images
