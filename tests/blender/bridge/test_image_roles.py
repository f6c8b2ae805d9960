# SPDX-License-Identifier: GPL-3.0-or-later

"""Roles of images in shaders, through the nodes that people and importers put between them."""

import bpy
import pytest
import scenes


@pytest.fixture
def picture():
    return scenes.image("Paint", scenes.noise(4, 4))


@pytest.fixture
def tree():
    material = bpy.data.materials.new("Wood")
    scenes.use_nodes(material)
    return material.node_tree


@pytest.fixture
def roles(addon, tree):
    """Returns a function that gives the roles as tuples."""
    material = next(m for m in bpy.data.materials if m.node_tree == tree)

    def found():
        return {
            (role.image.name, role.label, role.use, role.channel, role.is_factor)
            for role in addon("bridge.image_roles").roles(material)
        }

    return found


def shader(tree):
    return next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")


def math(tree, operation, source, *values, index=0):
    """Adds a Math node that gets a socket and constants, and returns its output."""
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    tree.links.new(source, node.inputs[index])
    others = [i for i in range(3) if i != index]
    for i, value in zip(others, values, strict=False):
        node.inputs[i].default_value = value
    return node.outputs[0]


def test_channels_of_a_packed_image(roles, tree, picture):
    texture = scenes.image_node(tree, picture)
    apart = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(texture.outputs["Color"], apart.inputs[0])
    scaled = math(tree, "MULTIPLY", apart.outputs["Green"], 0.5)
    tree.links.new(scaled, shader(tree).inputs["Roughness"])
    tree.links.new(apart.outputs["Blue"], shader(tree).inputs["Metallic"])
    inner = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
    inner.interface.new_socket("Occlusion", in_out="INPUT", socket_type="NodeSocketFloat")
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = inner
    tree.links.new(apart.outputs["Red"], group.inputs["Occlusion"])
    assert roles() == {
        ("Paint", "Roughness", "data", "green", False),
        ("Paint", "Metallic", "data", "blue", False),
        ("Paint", "Occlusion", "data", "red", False),
    }


def test_colors_mixed_by_a_mask(roles, tree, picture):
    mask = scenes.image("Mask", scenes.noise(4, 4))
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    tree.links.new(scenes.image_node(tree, mask).outputs["Color"], mix.inputs["Factor"])
    tree.links.new(scenes.image_node(tree, picture).outputs["Color"], mix.inputs[6])
    tree.links.new(mix.outputs[2], shader(tree).inputs["Base Color"])
    assert roles() == {
        ("Paint", "Base Color", "color", "all", False),
        ("Mask", "Base Color", "color", "all", True),
    }


def test_combined_channels_are_followed(roles, tree, picture):
    other = scenes.image("Other", scenes.noise(4, 4))
    together = tree.nodes.new("ShaderNodeCombineColor")
    for image, name in ((picture, "Red"), (other, "Green")):
        texture = scenes.image_node(tree, image)
        tree.links.new(texture.outputs["Alpha"], together.inputs[name])
    apart = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(together.outputs[0], apart.inputs[0])
    tree.links.new(apart.outputs["Green"], shader(tree).inputs["Roughness"])
    assert roles() == {("Other", "Roughness", "data", "alpha", False)}


@pytest.mark.parametrize("muted", ["ShaderNodeGamma", "ShaderNodeTexImage"])
def test_muted_nodes_are_bypassed(roles, tree, picture, muted):
    texture = scenes.image_node(tree, picture)
    gamma = tree.nodes.new("ShaderNodeGamma")
    tree.links.new(texture.outputs["Color"], gamma.inputs["Color"])
    tree.links.new(gamma.outputs[0], shader(tree).inputs["Base Color"])
    tree.links.new(texture.outputs["Alpha"], gamma.inputs["Gamma"])
    next(node for node in tree.nodes if node.bl_idname == muted).mute = True
    is_shown = muted == "ShaderNodeGamma"
    assert roles() == ({("Paint", "Base Color", "color", "all", False)} if is_shown else set())


def test_bumps_and_normals(roles, tree, picture):
    heights = scenes.image("Heights", scenes.noise(4, 4))
    normal_map = tree.nodes.new("ShaderNodeNormalMap")
    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(scenes.image_node(tree, picture).outputs[0], normal_map.inputs["Color"])
    tree.links.new(scenes.image_node(tree, heights).outputs[0], bump.inputs["Height"])
    tree.links.new(normal_map.outputs[0], bump.inputs["Normal"])
    tree.links.new(bump.outputs[0], shader(tree).inputs["Normal"])
    assert roles() == {
        ("Paint", "Normal Map", "normal", "all", False),
        ("Heights", "Bump", "data", "all", False),
    }


def gltf_clip(tree, alpha):
    """1 - (alpha < 0.3), as Blender's importer writes it."""
    return math(tree, "SUBTRACT", math(tree, "LESS_THAN", alpha, 0.3), 1.0, index=1)


def ramp(tree, alpha):
    node = tree.nodes.new("ShaderNodeValToRGB")
    node.color_ramp.interpolation = "CONSTANT"
    node.color_ramp.elements[1].position = 0.6
    tree.links.new(alpha, node.inputs[0])
    return node.outputs["Color"]


@pytest.mark.parametrize(
    ("clip", "threshold"),
    [
        (lambda tree, alpha: alpha, None),
        (lambda tree, alpha: math(tree, "MULTIPLY", alpha, 0.5), None),
        (lambda tree, alpha: math(tree, "GREATER_THAN", alpha, 0.25), 0.25),
        (lambda tree, alpha: math(tree, "LESS_THAN", alpha, 0.75, index=1), 0.75),
        (lambda tree, alpha: math(tree, "ROUND", alpha), 0.5),
        (lambda tree, alpha: math(tree, "COMPARE", alpha, 1.0, 0.4), 0.6),
        (gltf_clip, 0.3),
        (lambda tree, alpha: gltf_clip(tree, math(tree, "MULTIPLY", alpha, 0.5)), 0.6),
        (lambda tree, alpha: gltf_clip(tree, math(tree, "SUBTRACT", alpha, 1.0, index=1)), 0.7),
        (lambda tree, alpha: gltf_clip(tree, math(tree, "ADD", alpha, -0.1)), 0.4),
        (lambda tree, alpha: gltf_clip(tree, math(tree, "MULTIPLY_ADD", alpha, 2, -0.5)), 0.4),
        (ramp, 0.6),
    ],
)
@pytest.mark.parametrize("way", ["Alpha", "Mix Shader"])
def test_alpha_tests(addon, tree, picture, clip, threshold, way):
    texture = scenes.image_node(tree, picture)
    result = clip(tree, texture.outputs["Alpha"])
    if way == "Alpha":
        tree.links.new(result, shader(tree).inputs["Alpha"])
    else:
        mix = tree.nodes.new("ShaderNodeMixShader")
        clear = tree.nodes.new("ShaderNodeBsdfTransparent")
        tree.links.new(result, mix.inputs[0])
        tree.links.new(clear.outputs[0], mix.inputs[1])
    material = next(m for m in bpy.data.materials if m.node_tree == tree)
    (role,) = addon("bridge.image_roles").roles(material)
    assert (role.use, role.channel) == ("coverage", "alpha")
    assert role.threshold == (threshold if threshold is None else pytest.approx(threshold))


def test_roughness_and_its_normal_map(addon, tree, picture):
    rough = scenes.image("Rough", scenes.noise(4, 4))
    coat = scenes.image("Coat", scenes.noise(4, 4))
    for image, name in ((picture, "Normal"), (coat, "Coat Normal")):
        node = tree.nodes.new("ShaderNodeNormalMap")
        tree.links.new(scenes.image_node(tree, image).outputs[0], node.inputs["Color"])
        bump = tree.nodes.new("ShaderNodeBump")
        tree.links.new(node.outputs[0], bump.inputs["Normal"])
        tree.links.new(bump.outputs[0], shader(tree).inputs[name])
    texture = scenes.image_node(tree, rough)
    tree.links.new(texture.outputs[0], shader(tree).inputs["Roughness"])
    material = next(m for m in bpy.data.materials if m.node_tree == tree)
    (found,) = addon("bridge.image_roles").roughness(material)
    assert (found.image, found.channel, found.normal_maps) == (rough, "all", (picture,))
