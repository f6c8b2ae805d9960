# SPDX-License-Identifier: GPL-3.0-or-later

"""Materials: which UV map a node reads, and how it is moved."""

import bpy
import numpy as np
import pytest
import scenes

IDENTITY = ((1, 0, 0), (0, 1, 0))


@pytest.fixture
def picture():
    return scenes.image("Paint", scenes.noise(4, 4))


@pytest.fixture
def tree(picture):
    return scenes.material("Wood", picture).node_tree


def only_use(addon, tree, picture):
    uses, warnings = find(addon, tree, picture)
    assert warnings == []
    assert len(uses) == 1
    return uses[0]


def find(addon, tree, picture):
    material = next(m for m in bpy.data.materials if m.node_tree == tree)
    return addon("bridge.materials").image_uses(material, picture)


def texture_node(tree):
    return next(node for node in tree.nodes if node.type == "TEX_IMAGE")


def add(tree, kind, output=None, **values):
    """Adds a node and links its output to the Vector of the image node."""
    node = tree.nodes.new(kind)
    for name, value in values.items():
        setattr(node, name, value)
    tree.links.new(node.outputs[output or 0], texture_node(tree).inputs["Vector"])
    return node


def test_unlinked_reads_render_map(addon, tree, picture):
    use = only_use(addon, tree, picture)
    assert use.uv_map == ""
    np.testing.assert_array_equal(use.transform, IDENTITY)
    assert use.extension == "REPEAT"


def test_texture_coordinate(addon, tree, picture):
    add(tree, "ShaderNodeTexCoord", "UV")
    assert only_use(addon, tree, picture).uv_map == ""


def test_uv_map_node(addon, tree, picture):
    add(tree, "ShaderNodeUVMap", uv_map="Second")
    assert only_use(addon, tree, picture).uv_map == "Second"


def test_attribute_node(addon, tree, picture):
    add(tree, "ShaderNodeAttribute", "Vector", attribute_name="Second")
    assert only_use(addon, tree, picture).uv_map == "Second"


@pytest.mark.parametrize("kind", ["POINT", "TEXTURE", "VECTOR"])
def test_mapping(addon, tree, picture, kind):
    mapping = add(tree, "ShaderNodeMapping")
    mapping.inputs["Location"].default_value = (0.5, 0.25, 0)
    mapping.inputs["Rotation"].default_value = (0, 0, np.pi / 2)
    mapping.inputs["Scale"].default_value = (2, 4, 1)
    mapping.vector_type = kind
    source = tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(source.outputs[0], mapping.inputs["Vector"])
    rows = np.array(only_use(addon, tree, picture).transform)
    u, v = rows @ (0.3, 0.7, 1.0)
    expected = {
        "POINT": (-4 * 0.7 + 0.5, 2 * 0.3 + 0.25),
        "VECTOR": (-4 * 0.7, 2 * 0.3),
        "TEXTURE": ((0.7 - 0.25) / 2, -(0.3 - 0.5) / 4),
    }
    assert (u, v) == pytest.approx(expected[kind], abs=1e-6)


def test_reroute_muted_nodes_and_two_mappings(addon, tree, picture):
    last = add(tree, "ShaderNodeMapping")
    last.inputs["Location"].default_value = (0.5, 0, 0)
    first = tree.nodes.new("ShaderNodeMapping")
    first.inputs["Scale"].default_value = (3, 1, 1)
    ignored = tree.nodes.new("ShaderNodeMapping")
    ignored.inputs["Scale"].default_value = (100, 100, 1)
    ignored.mute = True
    reroute = tree.nodes.new("NodeReroute")
    source = tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(source.outputs[0], ignored.inputs["Vector"])
    tree.links.new(ignored.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], first.inputs["Vector"])
    tree.links.new(first.outputs[0], last.inputs["Vector"])
    use = only_use(addon, tree, picture)
    np.testing.assert_allclose(use.transform, ((3, 0, 0.5), (0, 1, 0)), atol=1e-6)


def test_image_inside_a_group_and_coordinates_from_a_group(addon, tree, picture):
    coordinates = bpy.data.node_groups.new("Coordinates", "ShaderNodeTree")
    coordinates.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketVector")
    source = coordinates.nodes.new("ShaderNodeUVMap")
    source.uv_map = "Second"
    end = coordinates.nodes.new("NodeGroupOutput")
    coordinates.links.new(source.outputs[0], end.inputs[0])

    textures = bpy.data.node_groups.new("Textures", "ShaderNodeTree")
    textures.interface.new_socket("Place", in_out="INPUT", socket_type="NodeSocketVector")
    node = scenes.image_node(textures, picture)
    start = textures.nodes.new("NodeGroupInput")
    textures.links.new(start.outputs[0], node.inputs["Vector"])

    tree.nodes.remove(texture_node(tree))
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = textures
    inner = tree.nodes.new("ShaderNodeGroup")
    inner.node_tree = coordinates
    tree.links.new(inner.outputs[0], outer.inputs[0])
    assert only_use(addon, tree, picture).uv_map == "Second"


def test_two_nodes_two_maps(addon, tree, picture):
    add(tree, "ShaderNodeUVMap", uv_map="Second")
    scenes.image_node(tree, picture)
    scenes.image_node(tree, picture)
    uses, _ = find(addon, tree, picture)
    assert sorted(use.uv_map for use in uses) == ["", "Second"]


def test_other_images_and_muted_nodes_do_not_count(addon, tree, picture):
    other = scenes.image("Other", scenes.noise(4, 4))
    scenes.image_node(tree, other)
    texture_node(tree).mute = True
    assert find(addon, tree, picture) == ([], [])


@pytest.mark.parametrize("output", ["Generated", "Object", "Window"])
def test_other_coordinates_are_skipped_with_a_warning(addon, tree, picture, output):
    add(tree, "ShaderNodeTexCoord", output)
    uses, warnings = find(addon, tree, picture)
    assert uses == []
    assert len(warnings) == 1
    assert "'Wood'" in warnings[0]
    assert output in warnings[0]


def test_arithmetic_is_skipped_with_a_warning(addon, tree, picture):
    add(tree, "ShaderNodeVectorMath")
    uses, warnings = find(addon, tree, picture)
    assert uses == []
    assert "'Vector Math'" in warnings[0]


def test_mapping_that_is_no_constant(addon, tree, picture):
    mapping = add(tree, "ShaderNodeMapping")
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs["Color"], mapping.inputs["Location"])
    uses, warnings = find(addon, tree, picture)
    assert uses == []
    assert "Location" in warnings[0]


def test_box_projection_is_skipped(addon, tree, picture):
    texture_node(tree).projection = "BOX"
    uses, warnings = find(addon, tree, picture)
    assert uses == []
    assert "BOX" in warnings[0]
