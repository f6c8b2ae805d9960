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


def test_the_active_material_chooses_the_image_without_an_editor():
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


def test_reports_the_result(capfd):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    bake(image="Paint", levels=3)
    assert (
        "Baked 'Paint' with PAM Bilinear over 1 object into 2 level images"
        in capfd.readouterr().out
    )


def test_warns_of_excluded_objects(capfd):
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
    bake(image="Paint", result="file", filepath="//paint.exr")
    assert (tmp_path / "paint.exr").exists()
    assert "Paint.mip01" not in bpy.data.images


def test_a_file_without_a_name_gets_that_of_the_image(tmp_path):
    image = scenes.image("Paint.png", scenes.noise(8, 8))
    scenes.textured_quad(image)
    with pytest.raises(RuntimeError, match=r"File: goes beside the \.blend file; save that first"):
        bake(image="Paint.png", result="file")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert bake(image="Paint.png", result="file") == {"FINISHED"}
    assert bake(image="Paint.png", result="file", file_format="dds") == {"FINISHED"}
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *("Paint.dds", "Paint.ktx2", "scene.blend")
    ]


def test_the_file_of_the_image_itself_is_kept(tmp_path):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    image.filepath_raw = str(tmp_path / "Paint.tif")
    (tmp_path / "Paint.tif").write_bytes(b"own")
    assert bake(image="Paint", file_format="tif") == {"FINISHED"}
    assert (tmp_path / "Paint.tif").read_bytes() == b"own"
    assert (tmp_path / "Paint_2.tif").exists()


def test_a_given_file_sets_the_result(tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    assert bake(image="Paint", filepath=str(tmp_path / "out.exr")) == {"FINISHED"}
    assert (tmp_path / "out.exr").exists()
    assert "Paint.mip01" not in bpy.data.images


def test_images_are_the_result_whatever_the_file_was(tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    path = tmp_path / "out.exr"
    assert bake(image="Paint", result="images", filepath=str(path)) == {"FINISHED"}
    assert not path.exists()
    assert "Paint.mip01" in bpy.data.images


def test_a_preview_leaves_nothing_in_the_file(addon):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    assert bake(image="Paint", result="preview") == {"FINISHED"}
    assert addon("textures.view.preview").find(image).last_level == 3
    assert sorted(one.name for one in bpy.data.images) == ["Paint"]


def test_the_ending_follows_the_format():
    settings = bpy.context.scene.prefilter_bake
    settings.result = "file"
    settings.filepath = "/out/paint.DDS"
    assert settings.file_format == "dds"
    settings.file_format = "exr"
    assert settings.filepath == "/out/paint.exr"
    settings.filepath = "/out/paint.tiff"
    assert settings.file_format == "tif"
    assert settings.filepath == "/out/paint.tiff"
    settings.filepath = "/out/paint.v2"
    assert settings.file_format == "tif"
    assert settings.to_settings().filepath == "/out/paint.v2.tif"
    settings.file_format = "png"
    assert settings.to_settings().filepath == "/out/paint.v2.png"


def test_importance_suggests_groups_and_attributes(addon):
    quad = scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    quad.vertex_groups.new(name="Face").add(range(4), 0.5, "REPLACE")
    dirt = quad.data.attributes.new("Dirt", "FLOAT", "POINT")
    dirt.data.foreach_set("value", [1.0] * 4)
    quad.data.attributes.new("Paint", "BYTE_COLOR", "CORNER")
    quad.data.attributes.new("Sharpness", "FLOAT", "EDGE")
    quad.data.attributes.new("Flow", "FLOAT_VECTOR", "POINT")
    found = addon("textures.importance").suggested_names(None, bpy.context, "")
    assert {"Face", "Dirt", "Paint"} <= set(found)
    assert not {"Sharpness", "Flow", "position", ".corner_vert"} & set(found)
    assert len(found) == len(set(found))
    for name in ("Face", "Dirt"):
        assert bake(image="Paint", importance=name, filter="box") == {"FINISHED"}


def test_file_for_engines(tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    path = tmp_path / "out.dds"
    options = {"image": "Paint", "filepath": str(path), "texture_format": "bc3"}
    assert bake(**options) == {"FINISHED"}
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
