# SPDX-License-Identifier: GPL-3.0-or-later

"""Nodes between images and shaders, which Blender's glTF exporter passes by."""

import bpy
import numpy as np
import pytest
import scenes
from command_line import run
from gltf_trees import read_tree
from node_chains import curved, flipped, inverted, multiplied, noisy


@pytest.fixture
def painted(tmp_path):
    """Returns a function that links an image, by nodes, to an input, and bakes a glTF file."""

    def make(name, build, *, colorspace="Non-Color"):
        pixels = scenes.noise(16, 16)
        cube = scenes.cube(scenes.image("Paint", pixels, colorspace=colorspace))
        tree = cube.active_material.node_tree
        shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
        output = build(tree, texture.outputs["Color"])
        if name == "Normal":
            node = tree.nodes.new("ShaderNodeNormalMap")
            tree.links.new(output, node.inputs["Color"])
            output = node.outputs[0]
        tree.links.new(output, shader.inputs[name])
        source, target = tmp_path / "in.blend", tmp_path / "out" / "out.gltf"
        target.parent.mkdir()
        bpy.ops.wm.save_as_mainfile(filepath=str(source))
        words = ("bake", source, "--all", "--output", target, "--fallback", "picture")
        result = run(*words)
        assert result.returncode == 0, result.stderr
        tree = read_tree(target)
        pictures = [one for one in tree["images"] if one["mimeType"] == "image/png"]
        bpy.data.images.load(str(target.with_name(pictures[0]["uri"]))).name = "Result"
        return pixels[..., :3], scenes.pixels("Result")[..., :3], tree["materials"][0], result

    return make


def close(found, expected):
    np.testing.assert_allclose(found, expected, atol=0.51 / 255)


@pytest.mark.parametrize("build", [flipped, curved])
def test_green_of_a_normal_map_for_directx_is_turned(painted, build):
    pixels, found, material, _ = painted("Normal", build)
    pixels[..., 1] = 1 - pixels[..., 1]
    close(found, pixels)
    assert "normalTexture" in material


def test_colors_are_changed_as_light(painted):
    pixels, found, _, _ = painted("Base Color", inverted, colorspace="sRGB")
    close(found, scenes.to_srgb(1 - scenes.to_linear(pixels)))


def test_a_factor_of_the_file_stays_one(painted):
    """Changed before it, the picture has the rest alone."""
    pixels, found, material, _ = painted(
        "Base Color", lambda *args: multiplied(args[0], inverted(*args)), colorspace="sRGB"
    )
    close(found, scenes.to_srgb(1 - scenes.to_linear(pixels)))
    factor = material["pbrMetallicRoughness"]["baseColorFactor"]
    assert factor == pytest.approx([0.5, 0.25, 1, 1])


def test_a_factor_alone_leaves_the_picture(painted):
    pixels, found, material, _ = painted("Base Color", multiplied, colorspace="sRGB")
    close(found, pixels)
    assert "baseColorFactor" in material["pbrMetallicRoughness"]


def test_a_partial_factor_is_reported(painted):
    """Blender's exporter writes it in full."""

    def build(tree, color):
        output = multiplied(tree, color)
        inputs = {one.identifier: one for one in output.node.inputs}
        inputs["Factor_Float"].default_value = 0.5
        return output

    pixels, found, _, result = painted("Base Color", build, colorspace="sRGB")
    close(found, pixels)
    assert "it is exported as if its factor were 1" in result.stderr


def test_gloss_becomes_roughness(painted):
    """glTF files store roughness in the second channel."""

    def build(tree, color):
        apart, node = tree.nodes.new("ShaderNodeSeparateColor"), tree.nodes.new("ShaderNodeMath")
        tree.links.new(color, apart.inputs[0])
        node.operation, node.inputs[0].default_value = "SUBTRACT", 1.0
        tree.links.new(apart.outputs[1], node.inputs[1])
        return node.outputs[0]

    pixels, found, _, _ = painted("Roughness", build)
    close(found[..., 1], 1 - pixels[..., 1])


def test_other_nodes_are_named(painted):
    pixels, found, _, result = painted("Base Color", noisy, colorspace="sRGB")
    close(found, pixels)
    assert (
        "node 'Stains' before 'Base Color' is not applied as it is" in result.stdout + result.stderr
    )
