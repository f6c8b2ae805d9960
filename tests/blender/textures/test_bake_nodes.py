# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `bake --all` to files: nodes are applied, and each role gets a file."""

import bpy
import numpy as np
import pytest
import scenes
from command_line import run
from node_chains import curved, flipped, inverted, multiplied, noisy


def principled(tree):
    return next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")


def to_normal(tree, output):
    node = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(output, node.inputs["Color"])
    tree.links.new(node.outputs[0], principled(tree).inputs["Normal"])


def scene(colorspace="Non-Color"):
    """Returns the pixels of an image on a cube, the nodes, and the output of the image."""
    pixels = scenes.noise(16, 16)
    cube = scenes.cube(scenes.image("Paint", pixels, colorspace=colorspace))
    tree = cube.active_material.node_tree
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    return pixels[..., :3], tree, texture.outputs["Color"]


def baked(tmp_path, ending=".png"):
    """Bakes, and returns the messages and the files."""
    source = tmp_path / "in.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(source))
    result = run("bake", source, "--all", "--output", tmp_path / f"out/{{name}}{ending}")
    assert result.returncode == 0, result.stderr
    return result, sorted(path.name for path in (tmp_path / "out").iterdir())


def level_0(tmp_path, name="Paint"):
    loaded = bpy.data.images.load(str(tmp_path / "out" / f"{name}.00.png"))
    return scenes.pixels(loaded.name)[..., :3]


@pytest.mark.parametrize("build", [flipped, curved])
def test_green_of_a_normal_map_is_turned(tmp_path, build):
    pixels, tree, color = scene()
    to_normal(tree, build(tree, color))
    result, _ = baked(tmp_path)
    pixels[..., 1] = 1 - pixels[..., 1]
    np.testing.assert_allclose(level_0(tmp_path), pixels, atol=0.51 / 255)
    assert "image 'Paint' is baked with what nodes do: " in result.stderr


def test_colors_are_changed_as_light(tmp_path):
    pixels, tree, color = scene("sRGB")
    changed = multiplied(tree, inverted(tree, color))
    tree.links.new(changed, principled(tree).inputs["Base Color"])
    baked(tmp_path)
    # A multiplication just before the shader is a factor of the material.
    expected = scenes.to_srgb(1 - scenes.to_linear(pixels))
    np.testing.assert_allclose(level_0(tmp_path), expected, atol=0.51 / 255)


def test_a_channel_alone_is_changed(tmp_path):
    pixels, tree, color = scene()
    apart, minus = tree.nodes.new("ShaderNodeSeparateColor"), tree.nodes.new("ShaderNodeMath")
    tree.links.new(color, apart.inputs[0])
    minus.operation, minus.inputs[0].default_value = "SUBTRACT", 1.0
    tree.links.new(apart.outputs[1], minus.inputs[1])
    tree.links.new(minus.outputs[0], principled(tree).inputs["Roughness"])
    tree.links.new(apart.outputs[2], principled(tree).inputs["Metallic"])
    baked(tmp_path)
    pixels[..., 1] = 1 - pixels[..., 1]
    np.testing.assert_allclose(level_0(tmp_path), pixels, atol=0.51 / 255)


def test_inputs_that_disagree_leave_the_image(tmp_path):
    pixels, tree, color = scene()
    tree.links.new(inverted(tree, color), principled(tree).inputs["Roughness"])
    tree.links.new(color, principled(tree).inputs["Metallic"])
    result, _ = baked(tmp_path)
    np.testing.assert_allclose(level_0(tmp_path), pixels, atol=0.51 / 255)
    assert "is baked without what nodes do ('Invert" in result.stderr
    assert "inputs get different values of it, 'Metallic', 'Roughness'" in result.stderr


def test_other_nodes_are_named(tmp_path):
    pixels, tree, color = scene("sRGB")
    tree.links.new(noisy(tree, color), principled(tree).inputs["Base Color"])
    result, _ = baked(tmp_path)
    np.testing.assert_allclose(level_0(tmp_path), pixels, atol=0.51 / 255)
    assert "image 'Paint' is baked without node 'Stains' before Base Color" in result.stderr


def test_a_color_that_is_a_normal_map_too_has_two_files(tmp_path):
    """Each file equals that of an image with one of the roles alone."""
    _, tree, color = scene("sRGB")
    tree.links.new(color, principled(tree).inputs["Base Color"])
    result, files = baked(tmp_path, ".dds")
    assert files == ["Paint.dds"]
    alone = (tmp_path / "out" / "Paint.dds").read_bytes()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "in.blend"))
    tree = bpy.data.objects["Cube"].active_material.node_tree
    color = next(node for node in tree.nodes if node.type == "TEX_IMAGE").outputs["Color"]
    to_normal(tree, color)
    result, files = baked(tmp_path, ".dds")
    assert files == ["Paint.dds", "Paint_normal.dds"]
    assert (tmp_path / "out" / "Paint.dds").read_bytes() == alone
    assert (tmp_path / "out" / "Paint_normal.dds").read_bytes() != alone
    assert "Baked 2 images into 2 files" in result.stdout
    listing = run("bake", tmp_path / "in.blend", "--all", "--list").stdout
    assert "Normal Map" in listing
    assert "Paint_normal" in listing


def test_each_role_has_its_own_nodes(tmp_path):
    pixels, tree, color = scene("sRGB")
    tree.links.new(color, principled(tree).inputs["Base Color"])
    to_normal(tree, inverted(tree, color))
    _, files = baked(tmp_path)
    assert {"Paint.00.png", "Paint_normal.00.png"} <= set(files)
    np.testing.assert_allclose(level_0(tmp_path), pixels, atol=0.51 / 255)
    turned = scenes.to_srgb(1 - scenes.to_linear(pixels))
    np.testing.assert_allclose(level_0(tmp_path, "Paint_normal"), turned, atol=0.51 / 255)


def test_roughness_with_its_normal_map(tmp_path):
    """Both are changed by nodes before they are filtered together."""
    pixels, tree, color = scene()
    to_normal(tree, flipped(tree, color))
    gloss = np.full((16, 16, 4), 0.8, np.float32)
    texture = scenes.image_node(tree, scenes.image("Gloss", gloss, colorspace="Non-Color"))
    changed = inverted(tree, texture.outputs["Color"])
    tree.links.new(changed, principled(tree).inputs["Roughness"])
    result, files = baked(tmp_path)
    assert "Gloss.00.png" in files
    assert "levels compensate" in run("bake", tmp_path / "in.blend", "--all", "--list").stdout
    np.testing.assert_allclose(level_0(tmp_path, "Gloss"), 0.2, atol=0.51 / 255)
    pixels[..., 1] = 1 - pixels[..., 1]
    np.testing.assert_allclose(level_0(tmp_path), pixels, atol=0.51 / 255)
    assert result.stderr.count("is baked with what nodes do") == 2
