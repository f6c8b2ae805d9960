# SPDX-License-Identifier: GPL-3.0-or-later

"""Removing levels: deletes the results of an image's bakes, and nothing else."""

import bpy
import pytest
import scenes


@pytest.fixture
def baked():
    """Bakes two images into level images, and previews one."""
    for name in ("Paint", "Other"):
        scenes.textured_quad(scenes.image(name, scenes.noise(8, 8)), name)
        bpy.ops.prefilter.bake_mipmaps(image=name)
    bpy.ops.prefilter.bake_mipmaps(image="Paint", result="preview")
    return bpy.data.images["Paint"]


def names():
    return sorted(image.name for image in bpy.data.images)


def test_of_one_image(addon, baked, capfd):
    found = addon("textures.removal").has_levels
    assert found(baked)
    assert bpy.ops.prefilter.remove_levels(image="Paint") == {"FINISHED"}
    assert names() == ["Other", "Other.mip01", "Other.mip02", "Other.mip03", "Paint"]
    assert "Removed 1 preview and 3 level images" in capfd.readouterr().out
    assert not found(baked)
    assert found(bpy.data.images["Other"])
    with pytest.raises(RuntimeError, match="image 'Paint' has no levels to remove"):
        bpy.ops.prefilter.remove_levels(image="Paint")


def test_a_level_stands_for_its_image(baked):
    assert bpy.ops.prefilter.remove_levels(image="Paint.mip02") == {"FINISHED"}
    assert "Paint.mip01" not in names()
    assert "Paint" in names()


def test_only_chosen_kinds_are_removed(addon, baked):
    preview = addon("textures.view.preview")
    assert bpy.ops.prefilter.remove_levels(image="Paint", kinds={"preview"}) == {"FINISHED"}
    assert preview.find(baked) is None
    assert "Paint.mip03" in names()
    assert bpy.ops.prefilter.remove_levels(image="Paint", kinds={"images"}) == {"FINISHED"}
    assert "Paint.mip03" not in names()


def test_of_all_images(baked):
    assert bpy.ops.prefilter.remove_levels(use_all=True) == {"FINISHED"}
    assert names() == ["Other", "Paint"]
    with pytest.raises(RuntimeError, match="no image has levels to remove"):
        bpy.ops.prefilter.remove_levels(use_all=True)


def test_users_of_a_level_then_use_the_image(baked):
    material = bpy.data.objects["Other"].active_material
    node = scenes.image_node(material.node_tree, bpy.data.images["Paint.mip01"])
    bpy.ops.prefilter.remove_levels(image="Paint")
    assert node.image == baked


def test_poll():
    assert not bpy.ops.prefilter.remove_levels.poll()
