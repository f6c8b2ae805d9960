# SPDX-License-Identifier: GPL-3.0-or-later

"""Nodes between an image and a shader; each function returns their output."""

import bpy


def flipped(tree: bpy.types.NodeTree, color: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Turns green over, as normal maps for DirectX need it."""
    apart, together = (
        tree.nodes.new("ShaderNodeSeparateColor"),
        tree.nodes.new("ShaderNodeCombineColor"),
    )
    tree.links.new(color, apart.inputs[0])
    minus = tree.nodes.new("ShaderNodeMath")
    minus.operation, minus.inputs[0].default_value = "SUBTRACT", 1.0
    tree.links.new(apart.outputs[0], together.inputs[0])
    tree.links.new(apart.outputs[1], minus.inputs[1])
    tree.links.new(minus.outputs[0], together.inputs[1])
    tree.links.new(apart.outputs[2], together.inputs[2])
    return together.outputs[0]


def curved(tree: bpy.types.NodeTree, color: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Does the same by RGB Curves."""
    node = tree.nodes.new("ShaderNodeRGBCurve")
    points = node.mapping.curves[1].points
    points[0].location, points[1].location = (0, 1), (1, 0)
    node.mapping.update()
    tree.links.new(color, node.inputs["Color"])
    return node.outputs[0]


def inverted(tree: bpy.types.NodeTree, color: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Inverts the color."""
    node = tree.nodes.new("ShaderNodeInvert")
    tree.links.new(color, node.inputs["Color"])
    return node.outputs[0]


def multiplied(tree: bpy.types.NodeTree, color: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Multiplies by a constant, as a factor of the material."""
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type, node.blend_type = "RGBA", "MULTIPLY"
    inputs = {one.identifier: one for one in node.inputs}
    inputs["Factor_Float"].default_value = 1.0
    inputs["B_Color"].default_value = (0.5, 0.25, 1, 1)
    tree.links.new(color, inputs["A_Color"])
    return next(one for one in node.outputs if one.enabled)


def noisy(tree: bpy.types.NodeTree, color: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Mixes with a value that is no function of the texel."""
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type, node.name = "RGBA", "Dirt"
    inputs = {one.identifier: one for one in node.inputs}
    tree.links.new(color, inputs["A_Color"])
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.name = "Stains"
    tree.links.new(noise.outputs["Color"], inputs["B_Color"])
    return next(one for one in node.outputs if one.enabled)
